// Rows of Instance: matrices to anchor space.
uniform usamplerBuffer instances;
