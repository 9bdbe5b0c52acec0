// Attributes that are the same all over an instance: `instance_attribute_count` rows an instance.
#include "nodes/point.glsl"
#include "textures/scene_records.glsl"
uniform int instance_attributes;
uniform int instance_attribute_count;

vec4 instance_attribute(ShadingPoint at, int index) {
    int row = max(at.instance, 0) * instance_attribute_count + index;
    return uintBitsToFloat(texelFetch(scene_records, instance_attributes + row));
}
