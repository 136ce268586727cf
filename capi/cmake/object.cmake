# cmake -DAR=ar -DARCHIVE=libnoisefloor.a -DOBJECT=noisefloor.o -P object.cmake
#
# Takes out of cargo's static library what rustc made of all crates in link-time optimisation: one object, of which only
# nf_* can be seen. What else is there (compiler-builtins: fmodf, cbrt, ...) would shadow the C library's.
# Without an operating system all of the archive is kept.
cmake_minimum_required(VERSION 3.21)
execute_process(COMMAND "${AR}" t "${ARCHIVE}" OUTPUT_VARIABLE members COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "noisefloor-[^\r\n]*\\.o" members "${members}")
list(LENGTH members count)
if(NOT count EQUAL 1)
    message(FATAL_ERROR "noisefloor: ${ARCHIVE} has ${count} objects of noisefloor instead of one: link-time "
        "optimisation must be `fat`, with one unit of code generation")
endif()
get_filename_component(folder "${OBJECT}" DIRECTORY)
execute_process(COMMAND "${AR}" x "${ARCHIVE}" "${members}" WORKING_DIRECTORY "${folder}" COMMAND_ERROR_IS_FATAL ANY)
file(RENAME "${folder}/${members}" "${OBJECT}")
