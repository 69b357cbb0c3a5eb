# Read by CPack: the commit becomes part of the package's version ("0.1.0+0123456789ab").
file(STRINGS ${CPACK_FOVEA_COMMIT_FILE} commit LIMIT_COUNT 1)
string(REPLACE "-" "." commit "${commit}")
set(CPACK_DEBIAN_PACKAGE_VERSION "${CPACK_PACKAGE_VERSION}+${commit}")
