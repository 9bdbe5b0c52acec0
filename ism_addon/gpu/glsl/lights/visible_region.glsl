// The convex region of a light that is visible from a receiver: above the receiver's horizon, and within the spread's
// footprint, a disc on the light's plane about the receiver's projection. Coordinates x, y lie in the light's plane and
// start at its position. It is sampled in x over x_range, then in y along the chord at x.
struct VisibleRegion {
    vec3 x_axis, y_axis;
    vec3 horizon;            // points above it have horizon.x x + horizon.y y + horizon.z >= 0
    float height;            // of the receiver, m
    vec2 projection;         // of the receiver: the footprint's centre
    float footprint_radius;  // m
    vec2 axis_u, axis_v;     // of the shape: half sides, or semi-axes
    float width;             // the shape's largest x
    float slope;             // the chord at x is slope x +- half_chord; an ellipse's shortens towards both ends
    float half_chord;
    bool rectangle;
    bool clipped_by_horizon;
    bool clipped_by_footprint; // conservative: it may be true without a clip
    vec2 x_range;            // of the region
};

vec2 intersection(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); } // of two intervals

// The interval of x of the intersection of a disc and the half plane line.x x + line.y y + line.z >= 0.
vec2 disc_extent(vec2 centre, float radius, vec3 line) {
    float size = max(length(line.xy), 1e-30);
    vec2 n = line.xy / size;
    float d = clamp((dot(n, centre) + line.z / size) / radius, -1.0, 1.0), half_chord = sqrt(1.0 - d * d) * abs(n.y);
    vec2 ends = vec2(d - n.x >= 0.0 ? -1.0 : -d * n.x - half_chord, d + n.x >= 0.0 ? 1.0 : half_chord - d * n.x);
    return d > -1.0 ? centre.x + radius * ends : vec2(1.0, -1.0);
}

// The interval of t where slope t + height >= 0.
vec2 half_line(float slope, float height) {
    float end = -height / (abs(slope) > 1e-30 ? slope : 1e-30);
    return slope < -1e-30 ? vec2(-1e30, end) : vec2(end, 1e30);
}

VisibleRegion area_visible_region(Light light, vec3 p, vec3 n) {
    VisibleRegion region;
    vec3 centre = light.position - p, u = 0.5 * light.axis_u, v = 0.5 * light.axis_v;
    float height = -dot(light.normal, centre);
    vec3 to_projection = -(centre + height * light.normal);
    bool has_spread = SPREADS == 1 && light.spread_scale > 0.0;
    region.rectangle = is_rectangle(light);
    region.height = max(height, 0.0);
    region.footprint_radius = height * light.spread_tangent;
    // A rectangle's chords are parallel to v. Those of an ellipse with spread are perpendicular to the line from its
    // centre to the footprint's.
    float distance = length(to_projection);
    bool perpendicular = !region.rectangle && has_spread && distance > 0.0;
    region.y_axis = perpendicular ? cross(light.normal, to_projection / distance) : normalize(v);
    region.x_axis = cross(region.y_axis, light.normal);
    region.axis_u = vec2(dot(u, region.x_axis), dot(u, region.y_axis));
    region.axis_v = vec2(dot(v, region.x_axis), dot(v, region.y_axis));
    region.projection = vec2(dot(to_projection, region.x_axis), dot(to_projection, region.y_axis));
    vec2 x_of_axes = vec2(region.axis_u.x, region.axis_v.x);
    region.width = region.rectangle ? abs(region.axis_u.x) : length(x_of_axes);
    region.slope = region.rectangle
                       ? region.axis_u.y / region.axis_u.x
                       : dot(x_of_axes, vec2(region.axis_u.y, region.axis_v.y)) / (region.width * region.width);
    region.half_chord = region.rectangle ? length(v) : length(cross(u, v)) / region.width;
    region.horizon = vec3(dot(n, region.x_axis), dot(n, region.y_axis), dot(n, centre));
    float height_amplitude = region.rectangle ? abs(dot(n, u)) + abs(dot(n, v)) : length(vec2(dot(n, u), dot(n, v)));
    region.clipped_by_horizon = height_amplitude > region.horizon.z;
    float size = region.rectangle ? 2.0 * (length(u) + length(v)) : length(u) + length(v);
    region.clipped_by_footprint = has_spread && length(region.projection) + size > region.footprint_radius;

    region.x_range = vec2(-region.width, region.width);
    if (region.clipped_by_horizon && region.rectangle) {
        float slope = region.horizon.x + region.horizon.y * region.slope;
        region.x_range = intersection(
            region.x_range, half_line(slope, abs(region.horizon.y) * region.half_chord + region.horizon.z));
    } else if (region.clipped_by_horizon) { // the unit disc in x / width, (y - slope x) / half_chord
        vec3 line = vec3((region.horizon.x + region.horizon.y * region.slope) * region.width,
                         region.horizon.y * region.half_chord, region.horizon.z);
        region.x_range = intersection(region.x_range, region.width * disc_extent(vec2(0.0), 1.0, line));
    }
    if (region.clipped_by_footprint) {
        vec2 disc = region.projection;
        float radius = region.footprint_radius;
        region.x_range = intersection(region.x_range, disc.x + vec2(-radius, radius));
        if (region.rectangle) {
            region.x_range = intersection(
                region.x_range, disc_extent(disc, radius, vec3(region.slope, -1.0, region.half_chord)));
            region.x_range = intersection(
                region.x_range, disc_extent(disc, radius, vec3(-region.slope, 1.0, region.half_chord)));
        }
        if (region.clipped_by_horizon)
            region.x_range = intersection(region.x_range, disc_extent(disc, radius, region.horizon));
    }
    return region;
}

// The ends of the chord at x.
vec2 area_chord(VisibleRegion region, float x) {
    float t = x / region.width;
    float half_chord = region.half_chord * (region.rectangle ? 1.0 : sqrt(max(1.0 - t * t, 0.0)));
    vec2 y = region.slope * x + vec2(-half_chord, half_chord);
    if (region.clipped_by_horizon)
        y = intersection(y, half_line(region.horizon.y, region.horizon.x * x + region.horizon.z));
    if (region.clipped_by_footprint) {
        float dx = x - region.projection.x, radius = region.footprint_radius;
        float half_footprint = sqrt(max(radius * radius - dx * dx, 0.0));
        y = intersection(y, region.projection.y + vec2(-half_footprint, half_footprint));
    }
    return y;
}
