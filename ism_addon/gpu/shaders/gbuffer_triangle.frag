// Numbers start at 1: 0 is the background.
flat in uvec2 numbers;
out uvec2 id;

void main() {
    id = numbers;
}
