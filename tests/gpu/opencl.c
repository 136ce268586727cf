/* noisefloor_sampler.h on every OpenCL device that is there: the bits of the library, and draws per second.
 *
 *   opencl [OPTIONS of the compiler]
 *
 * Once with the table as it is, and once with its entries where threads of a row of pixels read them faster.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include "expected.h"
#include <CL/cl.h>

static uint32_t spread(uint32_t i) { return i ^ (i >> 6 & 63u); }
static const char *const spread_source =
    "uint spread(uint i) { return i ^ (i >> 6 & 63u); }\n"
    "#define NOISEFLOOR_TABLE(i) table[spread(i)]\n";
static const char *const source =
    "#include \"noisefloor_sampler.h\"\n"
    "#include \"sampler_of.h\"\n"
    "kernel void draws(global const uint *table, global float4 *out, uint first) {\n"
    "    nfs s = sampler_of(first + get_global_id(0));\n"
    "    nfs_floats four = nfs_draw4(s, table), two = nfs_draw2(s, table);\n"
    "    out[2 * get_global_id(0)] = (float4)(four.x, four.y, four.z, four.w);\n"
    "    out[2 * get_global_id(0) + 1] = (float4)(two.x, two.y, 0, 0);\n"
    "}\n";

static void check(cl_int status, const char *what)
{
    if (status != CL_SUCCESS)
        failed(what, (int)status);
}

/* How many of the draws differ. */
static size_t draw_on(cl_device_id device, const char *options, int is_spread)
{
    const char *const sources[] = {is_spread ? spread_source : "", source};
    static uint32_t entries[65536];
    char name[256] = "", log[4096] = "";
    cl_int status;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, &status);
    cl_command_queue queue;
    cl_program program;
    cl_kernel kernel;
    cl_mem table, out;
    float *drawn = (float *)malloc(BYTES);
    size_t different = 0;
    uint32_t i, round;
    double time = 0.0;
    check(status, "context");
    clGetDeviceInfo(device, CL_DEVICE_NAME, sizeof name, name, NULL);
    queue = clCreateCommandQueue(context, device, 0, &status);
    check(status, "queue");
    program = clCreateProgramWithSource(context, 2, (const char **)sources, NULL, &status);
    status = clBuildProgram(program, 1, &device, options, NULL, NULL);
    if (status != CL_SUCCESS) {
        clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, sizeof log, log, NULL);
        fprintf(stderr, "%s\n", log);
    }
    check(status, "program");
    kernel = clCreateKernel(program, "draws", &status);
    check(status, "kernel");
    for (i = 0; i < 65536; ++i)
        entries[is_spread ? spread(i) : i] = nf_sampler_table()[i];
    table = clCreateBuffer(context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof entries, entries, &status);
    check(status, "table");
    out = clCreateBuffer(context, CL_MEM_WRITE_ONLY, BYTES, NULL, &status);
    check(status, "buffer");
    for (round = 0; round < ROUNDS; ++round) {
        const cl_uint first = round * AT_ONCE;
        const size_t count = AT_ONCE;
        double start;
        check(clSetKernelArg(kernel, 0, sizeof table, &table), "argument");
        check(clSetKernelArg(kernel, 1, sizeof out, &out), "argument");
        check(clSetKernelArg(kernel, 2, sizeof first, &first), "argument");
        start = seconds();
        check(clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &count, NULL, 0, NULL, NULL), "run");
        check(clFinish(queue), "run");
        time += round > 0 ? seconds() - start : 0.0; /* the first compiles */
        check(clEnqueueReadBuffer(queue, out, CL_TRUE, 0, BYTES, drawn, 0, NULL, NULL), "read");
        different += differences(first, drawn);
    }
    report_device(name, is_spread ? "OpenCL C, spread" : "OpenCL C", different, time);
    clReleaseMemObject(table);
    clReleaseMemObject(out);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    free(drawn);
    return different;
}

int main(int argc, char **argv)
{
    cl_platform_id platforms[8];
    cl_uint platform_count = 0, p, devices = 0;
    size_t different = 0;
    check(clGetPlatformIDs(8, platforms, &platform_count), "platforms");
    for (p = 0; p < platform_count && p < 8; ++p) {
        cl_device_id all[8];
        cl_uint count = 0, d;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 8, all, &count) != CL_SUCCESS)
            continue;
        for (d = 0; d < count && d < 8; ++d, ++devices) {
            const char *options = argc > 1 ? argv[1] : "-Iinclude -Itests/gpu";
            different += draw_on(all[d], options, 0) + draw_on(all[d], options, 1);
        }
    }
    if (devices == 0)
        fprintf(stderr, "no OpenCL device\n");
    return devices == 0 || different > 0;
}
