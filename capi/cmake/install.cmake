# What goes where under the prefix. It may be moved: only noisefloor.pc of /usr, and folders outside, name it.
include(CMakePackageConfigHelpers)
# Those within the prefix are relative to it, however they were given; pc_... is how pkg-config is told.
foreach(folder IN ITEMS LIBDIR INCLUDEDIR DATADIR DOCDIR)
    file(RELATIVE_PATH relative "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_${folder}}")
    if(relative MATCHES "^\\.\\./")
        string(REPLACE " " "\\ " pc_${folder} "${CMAKE_INSTALL_FULL_${folder}}")
        continue()
    elseif(relative STREQUAL "")
        set(relative .)
    endif()
    set(CMAKE_INSTALL_${folder} "${relative}")
    set(pc_${folder} "\${prefix}/${relative}")
endforeach()
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/noisefloor")
set(pkgconfig_dir "${CMAKE_INSTALL_LIBDIR}/pkgconfig")

# They are links in the repository, which install() would copy as such.
foreach(header IN ITEMS noisefloor.h noisefloor.hpp noisefloor_sampler.h)
    file(REAL_PATH "${headers}/${header}" header)
    install(FILES "${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
endforeach()
file(REAL_PATH "${headers}/noisefloor" parts)
install(DIRECTORY "${parts}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h")
foreach(licence IN ITEMS LICENSE-MIT LICENSE-APACHE THIRD_PARTY.md)
    file(REAL_PATH "${licence}" licence)
    install(FILES "${licence}" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
endforeach()
# The tiles as files: for programs that read them (nf_tile_from_bytes), in place of the library's own; and the table of
# the sampler, for shaders.
# Outside the workspace there are none.
set(tilesdir "")
if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/../core/tiles")
    set(tiles "${CMAKE_INSTALL_DATADIR}/noisefloor/tiles")
    install(DIRECTORY ../core/tiles/ DESTINATION "${tiles}" FILES_MATCHING PATTERN "*.nft"
        PATTERN "*.bin")
    set(tilesdir "tilesdir=${pc_DATADIR}/noisefloor/tiles")
endif()

# One file of targets for each kind, so that a distribution can leave one out of a package.
if(NOISEFLOOR_STATIC)
    install(TARGETS noisefloor_static EXPORT noisefloor_static)
    install(EXPORT noisefloor_static NAMESPACE noisefloor:: FILE noisefloorStatic.cmake DESTINATION "${package_dir}")
endif()
if(NOISEFLOOR_SHARED)
    install(TARGETS noisefloor EXPORT noisefloor_shared)
    install(EXPORT noisefloor_shared NAMESPACE noisefloor:: FILE noisefloorShared.cmake DESTINATION "${package_dir}")
endif()

configure_package_config_file(cmake/noisefloorConfig.cmake.in noisefloorConfig.cmake
    INSTALL_DESTINATION "${package_dir}")
# 0.x: a minor version may break what an earlier one promised.
if(PROJECT_VERSION_MAJOR EQUAL 0)
    set(compatibility SameMinorVersion)
else()
    set(compatibility SameMajorVersion)
endif()
write_basic_package_version_file(noisefloorConfigVersion.cmake COMPATIBILITY ${compatibility})
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/noisefloorConfig.cmake"
    "${CMAKE_CURRENT_BINARY_DIR}/noisefloorConfigVersion.cmake" DESTINATION "${package_dir}")

file(RELATIVE_PATH prefix_from_pc "/prefix/${pkgconfig_dir}" "/prefix")
string(REGEX REPLACE "/$" "" prefix_from_pc "${prefix_from_pc}")
set(pc_prefix "\${pcfiledir}/${prefix_from_pc}")
# pkg-config leaves out the system's own folders only by their names.
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr" OR IS_ABSOLUTE "${pkgconfig_dir}")
    string(REPLACE " " "\\ " pc_prefix "${CMAKE_INSTALL_PREFIX}")
endif()
list(TRANSFORM mathematics PREPEND "-l" OUTPUT_VARIABLE libs_private)
configure_file(cmake/noisefloor.pc.in noisefloor.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/noisefloor.pc" DESTINATION "${pkgconfig_dir}")
