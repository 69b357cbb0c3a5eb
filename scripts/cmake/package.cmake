# Installation (`cmake --install BUILD --prefix DIR`) and the Debian package (scripts/package).
# The program finds its commit and the firmware in its own folder, so that it is installed with them below
# lib/fovea; bin/fovea is a link to it.
if(NOT TARGET fovea)
  return()
endif()
set(private lib/fovea)
install(TARGETS fovea RUNTIME DESTINATION ${private})
install(FILES ${PROJECT_BINARY_DIR}/fovea.commit DESTINATION ${private})
foreach(program fovea_firmware fovea_cameras fovea_views passthrough board_loader)
  install(FILES ${PROJECT_BINARY_DIR}/sw/firmware/${program}.elf DESTINATION ${private}/sw/firmware)
endforeach()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/install)
file(CREATE_LINK ../${private}/fovea ${PROJECT_BINARY_DIR}/install/fovea SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/install/fovea DESTINATION bin)
# Manual page and completion are printed by the program.
install(CODE "
  foreach(page \"man;fovea.1\" \"completion;bash;completion.bash\")
    list(POP_BACK page file)
    execute_process(COMMAND \"$<TARGET_FILE:fovea>\" \${page}
                    OUTPUT_FILE \"${PROJECT_BINARY_DIR}/install/\${file}\" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()")
install(FILES ${PROJECT_BINARY_DIR}/install/fovea.1 DESTINATION share/man/man1)
install(FILES ${PROJECT_BINARY_DIR}/install/completion.bash
        DESTINATION share/bash-completion/completions RENAME fovea)
# Experiments name their footage by a path that begins at their own folder.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/experiments DESTINATION share/fovea/scripts)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/traces/footage ${PROJECT_SOURCE_DIR}/traces/bus DESTINATION share/fovea/traces)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/sw/python/fovea DESTINATION lib/python3/dist-packages
        PATTERN __pycache__ EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/ci-example DESTINATION share/doc/fovea USE_SOURCE_PERMISSIONS
        PATTERN build EXCLUDE)
# The manual, with its links: the pages lie as in the source tree.
set(sources "")
foreach(folder model rtl sw scripts tb traces)
  list(APPEND sources ${PROJECT_SOURCE_DIR}/${folder}/*.md)
endforeach()
file(GLOB_RECURSE pages CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${sources})
foreach(page README.md CHANGELOG.md CONTRIBUTING.md ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${page} DESTINATION share/doc/fovea/${folder})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/fovea RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fovea)
set(CPACK_PACKAGE_CONTACT "The Fovea project <fovea@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "co-simulation of a DM365 camera board and its firmware")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS ffmpeg)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)
# The version ends in the commit, which is known when the package is made, not when it is configured.
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/scripts/cmake/package_version.cmake)
set(CPACK_FOVEA_COMMIT_FILE ${PROJECT_BINARY_DIR}/fovea.commit)
include(CPack)
