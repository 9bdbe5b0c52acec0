// The tables of SceneRecords. A uniform of each table's name is the first of its rows, as fetch_... of its record counts.
uniform usamplerBuffer scene_records;
