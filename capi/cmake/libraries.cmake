# The one object, and the targets noisefloor::noisefloor and noisefloor::noisefloor_static made of it.

# cargo knows better than CMake what to compile again, but not what to link again.
file(GLOB_RECURSE sources CONFIGURE_DEPENDS src/*.rs ../core/src/*.rs ../core/tiles/*.nft
    ../core/tiles/*.bin)
# What else decides what cargo makes; outside the workspace some of it is not there.
set(settings)
foreach(file Cargo.toml Cargo.lock ../Cargo.toml ../Cargo.lock ../core/Cargo.toml)
    if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
        list(APPEND settings "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
    endif()
endforeach()
# Some distributions remove the versions, for cargo to take their own.
set(locked "")
if(settings MATCHES "Cargo\\.lock")
    set(locked --locked)
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${settings} "${headers}/noisefloor/base.h")
set(archive "${NOISEFLOOR_CARGO_TARGET_DIR}/${cargo_target}/release/libnoisefloor.a")
set(object "${CMAKE_CURRENT_BINARY_DIR}/noisefloor.o")
# The profile is the workspace's; where the package stands alone nothing else says it.
set(profile CARGO_PROFILE_RELEASE_PANIC=abort CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1
    "CARGO_PROFILE_RELEASE_OPT_LEVEL=${NOISEFLOOR_OPT_LEVEL}")
add_custom_command(
    OUTPUT "${object}"
    COMMAND "${CMAKE_COMMAND}" -E env --unset=MAKEFLAGS ${profile}
        ${NOISEFLOOR_CARGO_ENVIRONMENT} "${NOISEFLOOR_CARGO}" ${cargo_build} --quiet --release ${locked} --lib
        --manifest-path "${CMAKE_CURRENT_SOURCE_DIR}/Cargo.toml" --target-dir "${NOISEFLOOR_CARGO_TARGET_DIR}"
    COMMAND "${CMAKE_COMMAND}" "-DAR=${CMAKE_AR}" "-DARCHIVE=${archive}" "-DOBJECT=${object}"
        -P "${CMAKE_CURRENT_SOURCE_DIR}/cmake/object.cmake"
    DEPENDS ${sources} cmake/object.cmake ${settings}
    # Where cargo looks for its configuration: that of vendored packages is the source's.
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    COMMENT "Compiling noisefloor with cargo"
    VERBATIM)
# Both libraries are made of it: without a target of its own, a parallel make would make it twice.
add_custom_target(noisefloor_object DEPENDS "${object}")
set_source_files_properties("${object}" PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)

# Where the processor has no such instruction, compilers call fmax and fmin.
set(mathematics "")
if(cargo_target MATCHES "^arm.*-linux-")
    set(mathematics m)
endif()

function(noisefloor_library name kind)
    add_library(${name} ${kind} "${object}")
    add_library(noisefloor::${name} ALIAS ${name})
    add_dependencies(${name} noisefloor_object)
    set_target_properties(${name} PROPERTIES LINKER_LANGUAGE C OUTPUT_NAME noisefloor)
    target_include_directories(${name} INTERFACE
        "$<BUILD_INTERFACE:${headers}>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
    target_link_libraries(${name} PRIVATE ${mathematics})
endfunction()

if(NOISEFLOOR_STATIC)
    noisefloor_library(noisefloor_static STATIC)
    if(CMAKE_SYSTEM_NAME STREQUAL Generic)
        # With compiler-builtins: these processors compute much in software, for which C's library need not have all.
        add_custom_command(TARGET noisefloor_static POST_BUILD
            COMMAND "${CMAKE_COMMAND}" -E copy "${archive}" "$<TARGET_FILE:noisefloor_static>" VERBATIM)
    endif()
endif()
if(NOISEFLOOR_SHARED)
    noisefloor_library(noisefloor SHARED)
    set_target_properties(noisefloor PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${NOISEFLOOR_ABI_VERSION}
        RUNTIME_OUTPUT_NAME noisefloor-${NOISEFLOOR_ABI_VERSION})
    # Elsewhere symbols have no versions: what can be seen of the object is exported.
    if(NOT WIN32 AND NOT APPLE)
        configure_file(cmake/noisefloor.map.in noisefloor.map @ONLY)
        set_target_properties(noisefloor PROPERTIES LINK_DEPENDS "${CMAKE_CURRENT_BINARY_DIR}/noisefloor.map")
        target_link_options(noisefloor PRIVATE LINKER:--no-undefined
            "LINKER:--version-script=${CMAKE_CURRENT_BINARY_DIR}/noisefloor.map")
    endif()
else()
    # Who links noisefloor::noisefloor gets what there is.
    add_library(noisefloor::noisefloor ALIAS noisefloor_static)
endif()
