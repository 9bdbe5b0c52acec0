// Arrays in textures of WIDTH columns, see layout.py.
ivec2 element(int i) { return ivec2(i % WIDTH, i / WIDTH); }
