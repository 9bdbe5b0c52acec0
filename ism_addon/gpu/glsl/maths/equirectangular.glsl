// A map of all directions: v grows from -z to +z, and u falls with the longitude.
const float HALF_TURN = 3.141592653589793;

vec2 map_from_direction(vec3 d) {
    float longitude = d.xy == vec2(0.0) ? 0.0 : atan(d.y, d.x);
    return vec2(0.5 - 0.5 * longitude / HALF_TURN, 1.0 - acos(clamp(d.z, -1.0, 1.0)) / HALF_TURN);
}

vec3 direction_from_map(vec2 uv) {
    vec2 angles = vec2(1.0 - 2.0 * uv.x, 1.0 - uv.y) * HALF_TURN;
    return vec3(sin(angles.y) * vec2(cos(angles.x), sin(angles.x)), cos(angles.y));
}
