// Whether `groups`, a bit for each, contains a group. Group -1 contains everything.
bool is_linked(uint groups, int group) { return group < 0 || ((groups >> group) & 1u) == 1u; }
