// Points on a segment, evenly by angle, or by the solid angle of a narrow strip along it (Urena, Fajardo & King 2013,
// "An area-preserving parametrization for spherical rectangles"). Its `start` counts from the foot of the perpendicular
// from the observer, which is `height` long. Results do not cancel for short and distant segments.

// The angle from which the segment is seen.
float segment_angle(float height, float start, float size) {
    return atan(size * height, height * height + start * (start + size));
}

// How far from the start the segment is seen from this angle.
float along_segment(float height, float start, float size, float angle) {
    float sine = sin(angle), rest = height * cos(angle) - start * sine;
    return min(sine * (height * height + start * start) / max(rest, 1e-30), size);
}

// A strip's solid angle over the angle from which its width is seen: the difference of the sines of the angles of its
// ends to the perpendicular.
float strip_length(float height, float start, float size) {
    float end = start + size, near = length(vec2(height, start)), far = length(vec2(height, end));
    if (start * end <= 0.0) return end / far - start / near;
    return height * height * size * abs(start + end) / max(abs(end * near + start * far) * near * far, 1e-37);
}

// How far from the start the strip_length is this one.
float along_strip(float height, float start, float size, float to) {
    float distance = length(vec2(height, start)), sine = start / distance, cosine = height / distance;
    float end_cosine = sqrt(max(cosine * cosine - to * (to + 2.0 * sine), 0.0));
    float t = to / max(cosine + end_cosine, 1e-30); // the tangent of half of the angle between both
    float rest = height * (1.0 - t * t) - 2.0 * start * t;
    return min(2.0 * t * distance * distance / max(rest, 1e-30), size);
}
