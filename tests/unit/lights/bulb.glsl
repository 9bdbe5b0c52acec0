// A point that sends the same intensity everywhere.
float bulb_irradiance(Light light, vec3 p, vec3 n) {
    vec3 to = light.position - p;
    return max(dot(n, to), 0.0) * pow(dot(to, to), -1.5);
}

LightSample bulb_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    return LightSample(light.position, bulb_irradiance(light, p, n));
}

float bulb_virtual_weight(Light light, vec3 v, vec3 n) { return max(-dot(n, v), 0.0) * pow(dot(v, v), -1.5); }
