# The programs of examples_c, compiled as their reader would, and run; the path tracer's parts, and the path tracer on
# Embree.
if(TESTS_UNDER MATCHES "tsan|valgrind")
    return()
endif()
if(TESTS_UNDER)
    set(fast -O1)
    set(fastest -O1)
else()
    set(fast -O2)
    set(fastest -O3)
endif()

# A program that prints errors, of which in each pair the second must be the smaller: LARGER:SMALLER,...
function(add_errors label program pairs)
    add_check(${label} ${program} "${CMAKE_COMMAND}" "-DPROGRAM=$<TARGET_FILE:${program}>" "-DPAIRS=${pairs}"
        -P "${CMAKE_CURRENT_SOURCE_DIR}/cmake/errors.cmake")
endfunction()

add_program(renderers pbrt_sampler ../examples_c/renderers/pbrt_sampler.cpp ${fast} -Wconversion -Wshadow)
add_errors(renderers pbrt_sampler independent:sampler,sampler:noisefloor)

add_program(train_mlp train_mlp ../examples_c/train_mlp.c ${fast})
add_program(fit_polynomial fit_polynomial ../examples_c/fit_polynomial.c ${fast})
add_program(fit_image fit_image ../examples_c/fit_image.cpp ${fastest})
foreach(name IN ITEMS train_mlp fit_polynomial fit_image)
    add_python(${name} refusals ${name}.py "$<TARGET_FILE:${name}>" refusals)
    # Under the sanitizers it is memory that is looked at, and slowly.
    if(TESTS_UNDER)
        add_python(${name} small ${name}.py "$<TARGET_FILE:${name}>" small)
    else()
        add_python(${name} results ${name}.py "$<TARGET_FILE:${name}>" results)
    endif()
endforeach()
if(TESTS_UNDER)
    return()
endif()

find_package(Threads REQUIRED)
foreach(source IN ITEMS integrate.c image.cpp shared.c strips.cpp)
    get_filename_component(name "${source}" NAME_WE)
    add_program(${name} ${name} ../examples_c/${source} ${fast})
    add_errors(${name} ${name} mean:noisefloor)
    target_link_libraries(${name} PRIVATE Threads::Threads)
endforeach()
# Its processes check their estimates themselves.
add_program(shards shards ../examples_c/shards.c ${fast})
add_check(shards shards shards)

add_python(documents code_in_docs documents.py "${CMAKE_C_COMPILER}" "${CMAKE_CXX_COMPILER}")
add_custom_target(documents)

# The library as its users have it: installed, or a part of their project.
foreach(name IN ITEMS projects examples)
    add_check(installed_${name} ${name} sh "${CMAKE_CURRENT_SOURCE_DIR}/package/installed.sh" ${name}
        "${CMAKE_CURRENT_BINARY_DIR}/installed" "${NOISEFLOOR_CARGO}" "${NOISEFLOOR_CARGO_TARGET_DIR}")
    add_to(installed_${name} noisefloor noisefloor_static)
endforeach()

# The path tracer: what it lists, what it promises of its options, what it refuses; and its parts one by one.
link_libraries(Threads::Threads)
add_program(pathtracer pathtracer ../examples_c/pathtracer.cpp ${fast})
add_python(pathtracer scenes_and_options path_tracer.py "$<TARGET_FILE:pathtracer>")
foreach(name IN ITEMS intersection lights known surfaces image_plane paths mis program)
    add_program(pathtracer_parts part_${name} pathtracer/${name}.cpp ${fast})
    add_check(pathtracer_parts ${name} part_${name})
endforeach()

# The path tracer's samplers and estimators on pictures of POV-Ray's; and our side of its patch.
add_program(povray povray_oracle povray/oracle.cpp ${fast})
add_python(povray scenes povray.py "$<TARGET_FILE:povray_oracle>" "${NOISEFLOOR_CARGO_TARGET_DIR}/povray")
add_program(povray_patch povray_begin povray/patched/begin.cpp)
target_sources(povray_begin PRIVATE povray/patched/bridge.cpp)
target_include_directories(povray_begin PRIVATE ../examples_c/pathtracer)
add_python(povray_patch patch povray_patch.py "$<TARGET_FILE:povray_begin>")

# Embree 4 where somebody installed it, which Debian 12 has not as a package.
find_path(embree_4 embree4/rtcore.h)
find_path(embree_3 embree3/rtcore.h)
find_path(assimp assimp/Importer.hpp)
if(NOT assimp OR NOT (embree_3 OR embree_4))
    message(STATUS "without tests/embree: libembree-dev or libassimp-dev is missing")
    return()
endif()
add_program(embree_scenes embree_main embree/main.cpp ${fast})
add_program(embree_agreement embree_agreement embree/agreement.cpp ${fast})
add_program(embree_scenes embree_tables embree/tables.cpp ${fast})
foreach(program IN ITEMS main agreement tables)
    target_include_directories(embree_${program} PRIVATE ../examples_c)
    target_compile_definitions(embree_${program} PRIVATE "MESH_FOLDER=\"${CMAKE_CURRENT_SOURCE_DIR}/embree/meshes\"")
    target_link_libraries(embree_${program} PRIVATE $<IF:$<BOOL:${embree_4}>,embree4,embree3> assimp)
endforeach()
set_target_properties(embree_main PROPERTIES OUTPUT_NAME embree_harness)
add_check(embree_agreement every_scene embree_agreement)
add_python(embree_scenes scenes embree.py "$<TARGET_FILE:embree_main>")
