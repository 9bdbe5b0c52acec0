// A point light that sends the same intensity in all directions.
float bulb_irradiance(Light light, vec3 p, vec3 n) {
    vec3 to = light.position - p;
    return max(dot(n, to), 0.0) * pow(dot(to, to), -1.5);
}

LightSample bulb_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    vec3 to = light.position - p;
    return LightSample(light.position, normalize(to), 1.0 / dot(to, to), 1.0, -1);
}

float bulb_pdf(Light light, vec3 p, vec3 n, vec3 wi) { return 0.0; }

float bulb_emitted(Light light, vec3 p, vec3 wi) { return 0.0; }

float bulb_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    return max(-dot(n, v), 0.0) * pow(dot(v, v), -1.5);
}

vec3 bulb_centre(Light light, vec3 p, vec3 to) { return light.position; }

float bulb_hit_distance(Light light, vec3 p, vec3 wi) { return length(light.position - p); }
