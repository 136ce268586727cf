# noisefloor_sampler.h on the devices that are there; without a GPU these are PoCL, Mesa's lavapipe and
# Chromium's SwiftShader.
if(TESTS_UNDER)
    return()
endif()

# A GPU by nvcc; where there is none the program says so.
include(CheckLanguage)
set(CMAKE_CUDA_ARCHITECTURES OFF)
check_language(CUDA)
if(CMAKE_CUDA_COMPILER)
    set(CMAKE_CUDA_STANDARD 17)
    enable_language(CUDA)
    add_executable(gpu_nvcc gpu/cuda.cu)
    target_compile_options(gpu_nvcc PRIVATE -O2 -arch=native)
    target_link_libraries(gpu_nvcc PRIVATE noisefloor::noisefloor_static)
    add_to(gpu gpu_nvcc)
    add_check(gpu nvcc gpu_nvcc)
    set_tests_properties(gpu.nvcc PROPERTIES SKIP_RETURN_CODE 77)
endif()

find_package(OpenCL QUIET)
find_package(Vulkan QUIET)
find_program(glslang glslangValidator)
if(NOT OpenCL_FOUND OR NOT Vulkan_FOUND OR NOT glslang)
    return()
endif()
function(add_device_program name library)
    add_program(gpu gpu_${name} gpu/${name}.c -O2 -Wno-missing-field-initializers)
    target_link_libraries(gpu_${name} PRIVATE ${library})
    set_target_properties(gpu_${name} PROPERTIES C_STANDARD 11)
endfunction()
add_device_program(opencl OpenCL::OpenCL)
add_check(gpu opencl gpu_opencl)

# The same draws in GLSL and in HLSL; and what GLSL ES and the oldest GLSL must compile.
set(vulkan "")
set(shaders "")
foreach(shader IN ITEMS "GLSL sampler.comp -V" "HLSL sampler.hlsl -D -V -S comp -e main" "ES fragment.frag -V"
        "400 texture.frag -G --aml --amb")
    string(REPLACE " " ";" arguments "${shader}")
    list(POP_FRONT arguments language source)
    set(spirv "${CMAKE_CURRENT_BINARY_DIR}/${source}.spv")
    add_custom_command(OUTPUT "${spirv}" DEPENDS gpu/${source} gpu/sampler_of.h ../include/noisefloor_sampler.h
        COMMAND "${glslang}" ${arguments} "-I${root}/include" "-I${root}/tests/gpu" -o "${spirv}"
            "${root}/tests/gpu/${source}" VERBATIM)
    list(APPEND shaders "${spirv}")
    if(language MATCHES "SL$")
        list(APPEND vulkan ${language} "${spirv}")
    endif()
endforeach()
add_device_program(vulkan Vulkan::Vulkan)
add_custom_target(gpu_shaders DEPENDS ${shaders})
add_to(gpu gpu_shaders)
add_check(gpu vulkan gpu_vulkan ${vulkan})
# Chromium's, which the loader does not find by itself.
set(swiftshader /usr/lib/chromium/vk_swiftshader_icd.json)
if(EXISTS "${swiftshader}")
    add_check(gpu swiftshader gpu_vulkan ${vulkan})
    set_tests_properties(gpu.swiftshader PROPERTIES ENVIRONMENT "VK_ICD_FILENAMES=${swiftshader}")
endif()

# CUDA and HIP, of which clang compiles the host's side without the vendors' headers.
find_program(clang clang)
if(clang)
    foreach(language IN ITEMS cuda hip)
        set(object "${CMAKE_CURRENT_BINARY_DIR}/gpu_${language}.o")
        add_custom_command(OUTPUT "${object}"
            DEPENDS gpu/host.cu gpu/expected.h gpu/sampler_of.h ../include/noisefloor_sampler.h
            COMMAND "${clang}" -x ${language} --cuda-host-only -nocudainc -nocudalib -nogpuinc -nogpulib -O2 -Wall
                -Wextra -Werror -Wno-unused-function -Wno-unknown-cuda-version "-I${root}/include"
                -c "${root}/tests/gpu/host.cu" -o "${object}" VERBATIM)
        add_executable(gpu_${language} "${object}")
        set_target_properties(gpu_${language} PROPERTIES LINKER_LANGUAGE C)
        target_link_libraries(gpu_${language} PRIVATE noisefloor::noisefloor_static m)
        add_to(gpu gpu_${language})
        add_check(gpu ${language} gpu_${language})
    endforeach()
endif()

# OpenCL C and C++ compiled where no device is, for SPIR-V.
if(clang)
    set(kernel "${CMAKE_CURRENT_BINARY_DIR}/kernel.cl")
    file(CONFIGURE OUTPUT "${kernel}" CONTENT "#include \"noisefloor_sampler.h\"
kernel void draw(global const uint *table, global float *u) { *u = nfs_draw2(nfs_pixel(1u, 2u, 0u, 3u), table).x; }
")
    foreach(standard IN ITEMS CL1.2 CL2.0 clc++)
        add_check(gpu ${standard} "${clang}" -x cl -cl-std=${standard} -Xclang -finclude-default-header -target spir64
            -Werror -fsyntax-only "-I${root}/include" "${kernel}")
    endforeach()
endif()

# Operations of a draw, and Metal.
find_program(spirv_cross spirv-cross)
find_program(spirv_opt spirv-opt)
if(spirv_cross AND spirv_opt)
    add_python(gpu operations spirv.py "${glslang}" "${root}/include" "${CMAKE_CURRENT_SOURCE_DIR}/gpu/count.comp"
        "${CMAKE_CURRENT_BINARY_DIR}/spirv")
endif()
