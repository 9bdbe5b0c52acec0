// Whether a group is among those of `groups`, a bit for each; -1 is the group of all.
bool is_linked(uint groups, int group) { return group < 0 || ((groups >> group) & 1u) == 1u; }
