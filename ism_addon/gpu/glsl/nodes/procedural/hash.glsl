// Hashes of one to four numbers, as in Cycles. Of vectors, what is beyond the first `count` components has to be 0.

const float UINT_RANGE = 4294967296.0, POSITIVE_INT_RANGE = 2147483648.0;

uint rotated(uint word, int bits) { return word << bits | word >> 32 - bits; }

// Steps of lookup3 by Bob Jenkins.
void stir(inout uint a, inout uint b, uint c, int bits) {
    a = a - b ^ rotated(b, bits);
    b += c;
}

void finish(inout uint a, uint b, int bits) { a = (a ^ b) - rotated(b, bits); }

uint jenkins_hash(uvec4 words, int count) {
    uint start = 0xdeadbeefu + 4u * uint(count) + 13u;
    uint a = start + words.x, b = start + words.y, c = start + words.z;
    if (count > 3) {
        stir(a, c, b, 4);
        stir(b, a, c, 6);
        stir(c, b, a, 8);
        stir(a, c, b, 16);
        stir(b, a, c, 19);
        stir(c, b, a, 4);
        a += words.w;
    }
    finish(c, b, 14);
    finish(a, c, 11);
    finish(b, a, 25);
    finish(c, b, 16);
    finish(a, c, 4);
    finish(b, a, 14);
    finish(c, b, 24);
    return c;
}

// 0 to 1, by the bits of the numbers.
float hash_number(vec4 numbers, int count) {
    return float(jenkins_hash(floatBitsToUint(numbers), count)) / UINT_RANGE;
}

// The hash of the numbers with one more.
float hash_number(vec4 numbers, int count, float further) {
    numbers[count] = further;
    return hash_number(numbers, count + 1);
}

vec3 hash_color(vec4 numbers, int count) {
    float first = hash_number(numbers, count);
    if (count > 3) return vec3(first, hash_number(numbers.zxwy, count), hash_number(numbers.wzyx, count));
    return vec3(first, hash_number(numbers, count, 1.0), hash_number(numbers, count, 2.0));
}

// PCG hashes of integers to 0 ... 1 (Jarzynski & Olano 2020), but of signed ones.
const int PCG_FACTOR = 1664525, PCG_STEP = 1013904223, POSITIVE_BITS = 0x7FFFFFFF;

vec2 pcg_hash(ivec2 v) {
    v = v * PCG_FACTOR + PCG_STEP;
    for (int k = 0; k < 2; ++k) {
        v.x += v.y * PCG_FACTOR;
        v.y += v.x * PCG_FACTOR;
        if (k == 0) v ^= v >> 16;
    }
    return vec2(v & POSITIVE_BITS) / POSITIVE_INT_RANGE;
}

vec3 pcg_hash(ivec3 v) {
    v = v * PCG_FACTOR + PCG_STEP;
    for (int k = 0; k < 2; ++k) {
        v.x += v.y * v.z;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        if (k == 0) v ^= v >> 16;
    }
    return vec3(v & POSITIVE_BITS) / POSITIVE_INT_RANGE;
}

vec4 pcg_hash(ivec4 v) {
    v = v * PCG_FACTOR + PCG_STEP;
    for (int k = 0; k < 2; ++k) {
        v.x += v.y * v.w;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        v.w += v.y * v.z;
        if (k == 0) v ^= v >> 16;
    }
    return vec4(v & POSITIVE_BITS) / POSITIVE_INT_RANGE;
}
