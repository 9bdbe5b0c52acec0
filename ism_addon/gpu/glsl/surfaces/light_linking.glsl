// Whether a group is among those that something belongs to, a bit for each; -1 is the group of all.
bool linked(int groups, int group) { return group < 0 || ((groups >> group) & 1) == 1; }
