# The detectors of wrong memory and of data races: they find what breaks the rules, and nothing where these are kept.
if(TESTS_UNDER STREQUAL "valgrind")
    add_executable(undefined valgrind/undefined.c)
    target_compile_options(undefined PRIVATE -O1)
    add_to(c99 undefined)
    add_exit(c99 an_undefined_value_is_found 99 ${memcheck} "$<TARGET_FILE:undefined>")

    add_program(threads threads valgrind/threads.cpp -O1 -pthread)
    target_link_options(threads PRIVATE -pthread)
    foreach(tool IN ITEMS helgrind drd)
        set(detector "${valgrind}" --quiet --tool=${tool} --error-exitcode=99 "$<TARGET_FILE:threads>")
        add_check(threads ${tool}_an_accumulator_each ${detector})
        add_exit(threads ${tool}_finds_a_shared_accumulator 99 ${detector} race)
    endforeach()
elseif(TESTS_UNDER STREQUAL "tsan")
    # What the runtime may lack.
    add_library(tsan_memory OBJECT threads/tsan_memory.c)
    target_compile_options(tsan_memory PRIVATE -Wall -Wextra -pedantic -Werror -O1 -fno-builtin)
    set(under_objects tsan_memory)
    add_check(tsan the_library_is_instrumented "${CMAKE_NM}" --plugin=/none --undefined-only
        "$<TARGET_FILE:noisefloor_static>")
    set_tests_properties(tsan.the_library_is_instrumented PROPERTIES PASS_REGULAR_EXPRESSION __tsan_write8)

    add_program(tsan rules threads/rules.cpp -O1)
    add_check(tsan rules_kept ${under} "$<TARGET_FILE:rules>")
    foreach(broken IN ITEMS accumulator table generator tile)
        add_exit(tsan finds_${broken} 66 ${under} "$<TARGET_FILE:rules>" ${broken})
    endforeach()

    add_program(tsan pathtracer ../examples_c/pathtracer.cpp -O1)
    function(render name)
        add_check(tsan pathtracer_${name} ${under} "$<TARGET_FILE:pathtracer>"
            --width 24 --height 24 --spp 16 --threads 3 --output "${CMAKE_CURRENT_BINARY_DIR}/${name}" ${ARGN})
    endfunction()
    render(random --accumulate 4 --sampler random --estimators mc,robust,k_fold,incremental)
    render(tile --accumulate 4 --sampler tile --estimators mc,robust,k_fold,incremental)
    render(shared --frame 1 --sampler tile --estimators mc,robust,shared,shared_k_fold)
endif()
