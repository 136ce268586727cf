# What cargo compiles for: this machine, or what CMake compiles for.

# CMake's names of systems and processors, in Rust's. The library calls nothing of the system, so that one C library is
# as good as another.
function(noisefloor_rust_target result)
    set(processor "${CMAKE_SYSTEM_PROCESSOR}")
    if(CMAKE_OSX_ARCHITECTURES)
        set(processor "${CMAKE_OSX_ARCHITECTURES}")
    endif()
    string(TOLOWER "${processor}" processor)
    set(target "")
    if(processor MATCHES "^(aarch64|arm64)$")
        set(processor aarch64)
    elseif(processor MATCHES "^(x86_64|amd64)$")
        set(processor x86_64)
    elseif(processor MATCHES "^(i[3-6]86|x86)$")
        set(processor i686)
    endif()
    if(CMAKE_SYSTEM_NAME STREQUAL Linux)
        if(processor MATCHES "^(aarch64|x86_64|i686|s390x)$")
            set(target ${processor}-unknown-linux-gnu)
        elseif(processor MATCHES "^armv7")
            set(target armv7-unknown-linux-gnueabihf)
        elseif(processor STREQUAL riscv64)
            set(target riscv64gc-unknown-linux-gnu)
        elseif(processor STREQUAL ppc64le)
            set(target powerpc64le-unknown-linux-gnu)
        endif()
    elseif(CMAKE_SYSTEM_NAME STREQUAL Darwin AND processor MATCHES "^(aarch64|x86_64)$")
        set(target ${processor}-apple-darwin)
    elseif(MINGW AND processor MATCHES "^(aarch64|x86_64|i686)$")
        # Windows names the machine's processor, also to a compiler for 32 bits.
        if(CMAKE_SIZEOF_VOID_P EQUAL 4)
            set(processor i686)
        endif()
        set(target ${processor}-pc-windows-gnullvm)
    endif()
    set(${result} "${target}" PARENT_SCOPE)
endfunction()

set(rust_target "")
set(opt_level 3)
# Rust on Windows is for Microsoft's tools unless told otherwise, and on macOS for its own processor alone.
set(must_name_target OFF)
if(CMAKE_CROSSCOMPILING OR MINGW OR APPLE)
    set(must_name_target ON)
    noisefloor_rust_target(rust_target)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL Generic)
    # Without an operating system memory is scarce: for size it is less than half of the code.
    set(opt_level s)
endif()
set(NOISEFLOOR_RUST_TARGET "${rust_target}" CACHE STRING
    "What cargo compiles for (a name that `rustc --print target-list` has); empty: this machine")
set(NOISEFLOOR_OPT_LEVEL "${opt_level}" CACHE STRING "3: fast; s, z: small")
option(NOISEFLOOR_DOUBLE "Control variates in double precision; without, only NF_PRECISION_F32" ON)
set(NOISEFLOOR_CARGO_OPTIONS "" CACHE STRING "More options for cargo, separated by semicolons")
set(NOISEFLOOR_CARGO_ENVIRONMENT "" CACHE STRING "More of cargo's environment, NAME=VALUE, separated by semicolons")
if(must_name_target AND NOT NOISEFLOOR_RUST_TARGET)
    message(FATAL_ERROR
        "noisefloor: no Rust target is known for ${CMAKE_SYSTEM_NAME} on `${CMAKE_SYSTEM_PROCESSOR}`: name it, for "
        "example -DNOISEFLOOR_RUST_TARGET=thumbv7em-none-eabihf (`rustc --print target-list` has all)")
endif()
if(NOT NOISEFLOOR_OPT_LEVEL MATCHES "^[0123sz]$")
    message(FATAL_ERROR
        "noisefloor: NOISEFLOOR_OPT_LEVEL is `${NOISEFLOOR_OPT_LEVEL}`: it must be one of 0, 1, 2, 3, s and z")
endif()

# Named even where it is this machine: cargo's configuration may name another.
set(cargo_target "${NOISEFLOOR_RUST_TARGET}")
if(NOT cargo_target)
    execute_process(COMMAND "${NOISEFLOOR_CARGO}" --version --verbose OUTPUT_VARIABLE version
        WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
    string(REGEX REPLACE ".*\nhost: ([^\n]+).*" "\\1" cargo_target "${version}")
endif()
# Without the shared library, which cargo would link with this machine's linker.
set(cargo_build rustc --crate-type staticlib --target "${cargo_target}")
if(NOT NOISEFLOOR_DOUBLE)
    list(APPEND cargo_build --no-default-features)
endif()
list(APPEND cargo_build ${NOISEFLOOR_CARGO_OPTIONS})
