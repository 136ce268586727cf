/* noisefloor_sampler.h as CUDA, on the first GPU: the bits of the library, and draws per second beside those of other
 * samplers. Exits with 77 where there is no GPU.
 */
#include <stdint.h>

static __device__ uint32_t table[65536];

/* Where entry i is: as nf_sampler_table() has them, the threads of a row of pixels would read one bank of the cache. */
static __host__ __device__ uint32_t spread(uint32_t i) { return i ^ (i >> 6 & 63u); }

#if defined(__CUDA_ARCH__)
#define NOISEFLOOR_TABLE(i) __ldg(table + spread(i))
#else
#define NOISEFLOOR_TABLE(i) nf_sampler_table()[i]
#endif
#include "expected.h"
#include "sampler_of.h"
#include "peers.h"
#include <algorithm>

static void check(cudaError_t status, const char *what)
{
    if (status != cudaSuccess)
        failed(what, (int)status);
}

static __global__ void draws(float4 *out, uint32_t first)
{
    const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    const nfs s = sampler_of(first + i);
    const nfs_floats four = nfs_draw4(s), two = nfs_draw2(s);
    out[2 * i] = make_float4(four.x, four.y, four.z, four.w);
    out[2 * i + 1] = make_float4(two.x, two.y, 0, 0);
}

/* How many of the draws differ. */
static size_t compare(const char *device)
{
    static float drawn[AT_ONCE * 8];
    float4 *out;
    size_t different = 0;
    double time = 0.0;
    check(cudaMalloc(&out, BYTES), "memory");
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        const double start = seconds();
        draws<<<AT_ONCE / 256, 256>>>(out, round * AT_ONCE);
        check(cudaDeviceSynchronize(), "run");
        time += round > 0 ? seconds() - start : 0.0;
        check(cudaMemcpy(drawn, out, BYTES, cudaMemcpyDeviceToHost), "read");
        different += differences(round * AT_ONCE, drawn);
    }
    check(cudaFree(out), "memory");
    report_device(device, "CUDA", different, time);
    return different;
}

/* Draws to be timed: of sample `index` of a domain. */
struct Root {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t) const
    {
        return nfs_draw4(nfs_pixel(x, y, 0, index));
    }
};

struct Domain {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        return nfs_draw4(nfs_domain(nfs_pixel(x, y, 0, index), domain));
    }
};

struct DomainOf2 {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        return nfs_draw2(nfs_domain(nfs_pixel(x, y, 0, index), domain));
    }
};

struct White {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        return nfs_draw4(nfs_domain(nfs_white(x, y, 0, index), domain));
    }
};

constexpr uint32_t SIZE = 1024, RUNS = 9;

/* A thread is a pixel, in the image's order, and takes a sample and a domain after the other. */
template <class Draw> __global__ void sums(float *out, const Draw draw)
{
    const uint32_t x = blockIdx.x * blockDim.x + threadIdx.x, y = blockIdx.y;
    float sum = 0;
#pragma unroll 1
    for (uint32_t k = 0; k < SAMPLES; ++k) {
        const nfs_floats u = draw(x, y, k, k);
        sum += u.x + u.y + u.z + u.w;
    }
    out[y * SIZE + x] = sum;
}

/* The median of runs, of which the first is not timed. */
template <class Draw> void measure(const char *name, const Draw &draw)
{
    float *out, took[RUNS];
    cudaEvent_t start, end;
    check(cudaMalloc(&out, SIZE * SIZE * sizeof *out), "memory");
    check(cudaEventCreate(&start), "event");
    check(cudaEventCreate(&end), "event");
    for (uint32_t run = 0; run <= RUNS; ++run) {
        check(cudaEventRecord(start), "event");
        sums<<<dim3(SIZE / 256, SIZE), 256>>>(out, draw);
        check(cudaEventRecord(end), "event");
        check(cudaEventSynchronize(end), "run");
        check(cudaEventElapsedTime(&took[run > 0 ? run - 1 : 0], start, end), "event");
    }
    std::sort(took, took + RUNS);
    printf("  %-52s %6.1f draws a nanosecond\n", name, double(SIZE) * SIZE * SAMPLES / (1e6 * took[RUNS / 2]));
    check(cudaEventDestroy(start), "event");
    check(cudaEventDestroy(end), "event");
    check(cudaFree(out), "memory");
}

/* Any numbers do: here those of pixels. */
static Tile make_tile()
{
    static nfs_floats values[128 * 128];
    const cudaChannelFormatDesc format = cudaCreateChannelDesc<float4>();
    cudaResourceDesc resource = {};
    cudaTextureDesc description = {};
    cudaArray_t array;
    Tile tile;
    for (uint32_t k = 0; k < 128 * 128; ++k)
        values[k] = nfs_draw4(nfs_pixel(k & 127, k >> 7, 0, 0));
    check(cudaMallocArray(&array, &format, 128, 128), "tile");
    check(cudaMemcpy2DToArray(array, 0, 0, values, 128 * sizeof *values, 128 * sizeof *values, 128,
                              cudaMemcpyHostToDevice), "tile");
    resource.resType = cudaResourceTypeArray;
    resource.res.array.array = array;
    check(cudaCreateTextureObject(&tile.texture, &resource, &description, NULL), "tile");
    return tile;
}

int main()
{
    cudaDeviceProp device;
    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
        fprintf(stderr, "no CUDA device\n");
        return 77;
    }
    check(cudaGetDeviceProperties(&device, 0), "device");
    static uint32_t entries[65536], columns[4][32];
    for (uint32_t i = 0; i < 65536; ++i)
        entries[spread(i)] = nf_sampler_table()[i];
    check(cudaMemcpyToSymbol(table, entries, sizeof table), "table");
    const size_t different = compare(device.name);

    for (uint32_t d = 0; d < 4; ++d)
        for (uint32_t k = 0; k < 32; ++k)
            columns[d][k] = demo::Sobol().digits(1u << k, d);
    check(cudaMemcpyToSymbol(sobol_columns, columns, sizeof columns), "columns");
    measure("noisefloor, a pixel's own four numbers", Root());
    measure("noisefloor, a domain's two", DomainOf2());
    measure("noisefloor, a domain's four", Domain());
    measure("noisefloor, a domain's four, white", White());
    measure("Sobol's points, exclusive-or a hash, four", SobolXor());
    measure("Sobol's points, Owen-scrambled by hashes, four", SobolOwen());
    measure("a texture of 128 x 128 pixels and a rotation, four", make_tile());
    measure("a hash, pcg4d, four", Hash());
    return different > 0;
}
