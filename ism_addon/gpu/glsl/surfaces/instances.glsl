// Rows of Instance: matrices to anchor space.
#ifdef IN_SCENE_RECORDS
#include "textures/scene_records.glsl"
uniform int instances;
Instance instance_at(int index) { return fetch_Instance(scene_records, instances + max(index, 0)); }
#else
uniform usamplerBuffer instances;
Instance instance_at(int index) { return fetch_Instance(instances, index); }
#endif
