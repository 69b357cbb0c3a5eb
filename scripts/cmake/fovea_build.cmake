# Flags, packages and helper functions shared by every folder.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g1")
set(CMAKE_C_FLAGS_RELEASE "-O2 -g1")

# Full optimisation of the hot libraries (fovea_hot).
option(FOVEA_HOT "-O3 for what is on the path of every instruction or memory access (release builds with GCC)" ON)
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR NOT CMAKE_BUILD_TYPE STREQUAL "Release"
   OR FOVEA_SANITIZE OR FOVEA_COVERAGE)
  set(FOVEA_HOT OFF)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(launcher ${CMAKE_SOURCE_DIR}/scripts/cmake/launch.sh ${CCACHE} ${CMAKE_SOURCE_DIR})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()

if(FOVEA_SANITIZE STREQUAL "address")
  # Without optimisation, as the build takes longer than the tests; with some in the libraries that take most of a
  # run's time (fovea_hot).
  add_compile_options(-O0 -fsanitize=address,undefined -fno-sanitize-recover=undefined
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
elseif(FOVEA_SANITIZE STREQUAL "thread")
  add_compile_options(-O1 -fsanitize=thread -fno-omit-frame-pointer)
  add_link_options(-fsanitize=thread)
elseif(FOVEA_SANITIZE STREQUAL "fuzz")
  # For libFuzzer, with the lines that it reaches (clang only; tb/fuzz).
  add_compile_options(-O1 -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined
                      -fno-omit-frame-pointer -fprofile-instr-generate -fcoverage-mapping)
  add_link_options(-fsanitize=address,undefined -fprofile-instr-generate)
elseif(FOVEA_SANITIZE)
  message(FATAL_ERROR "FOVEA_SANITIZE is '${FOVEA_SANITIZE}'; it can be 'address', 'thread', 'fuzz' or empty")
endif()

if(FOVEA_COVERAGE)
  add_compile_options(-O1 --coverage -fprofile-update=atomic)
  add_link_options(--coverage)
endif()

if(FOVEA_PARANOID)
  add_compile_definitions(FOVEA_PARANOID)
endif()

# RE2 and GoogleTest ask for it; with one set of flags everywhere, precompiled headers fit everywhere.
add_compile_options(-pthread)

find_package(PkgConfig REQUIRED)
find_package(GTest)
find_package(fmt REQUIRED)
pkg_check_modules(SYSTEMC REQUIRED IMPORTED_TARGET systemc>=2.3.4)

add_library(fovea_warnings INTERFACE)
target_compile_options(fovea_warnings INTERFACE -Wall -Wextra -Wshadow -Wno-unused-parameter
                       # False alarms of GCC 12 in std::string.
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>)
target_include_directories(fovea_warnings INTERFACE ${PROJECT_SOURCE_DIR})

# SystemC for model code: the packaged library was built as C++17; SC_CPLUSPLUS is its own override.
# System include keeps its warnings out; the main headers are precompiled once per target.
add_library(fovea_systemc INTERFACE)
target_link_libraries(fovea_systemc INTERFACE PkgConfig::SYSTEMC fovea_warnings)
target_compile_definitions(fovea_systemc INTERFACE SC_CPLUSPLUS=201703L SC_ALLOW_DEPRECATED_IEEE_API)

# Adds a source folder, unless FOVEA_ONLY asks for others.
function(fovea_add_folder folder)
  if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${folder}/CMakeLists.txt)
    return()
  endif()
  if(FOVEA_ONLY AND NOT folder IN_LIST FOVEA_ONLY AND NOT folder STREQUAL "model/common"
     AND NOT folder STREQUAL "tb")
    return()
  endif()
  add_subdirectory(${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/${folder})
endfunction()

# fovea_library(NAME sources...): a model library; those that use SystemC add fovea_systemc themselves.
function(fovea_library name)
  add_library(${name} STATIC ${ARGN})
  target_link_libraries(${name} PUBLIC fovea_warnings)
endfunction()

# fovea_hot(NAME): a library on the path of every instruction or memory access.
function(fovea_hot name)
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  if(FOVEA_HOT)
    target_compile_options(${name} PRIVATE -O3 -fno-plt)
  elseif(FOVEA_SANITIZE STREQUAL "address")
    target_compile_options(${name} PRIVATE -O1)
  endif()
endfunction()

# fovea_cold(NAME): a library whose own time does not count beside that of a run: optimised less, built sooner.
function(fovea_cold name)
  if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT FOVEA_SANITIZE AND NOT FOVEA_COVERAGE)
    target_compile_options(${name} PRIVATE -O1)
  endif()
endfunction()

# fovea_test_paths(TARGET NAME="path"...): definitions of a test. A path within the project is written as from the folder
# in which ctest starts the test, so that the compiler's command is the same in every clone, and the compiler cache hits.
function(fovea_test_paths target)
  foreach(definition IN LISTS ARGN)
    if(definition MATCHES "^([A-Z_]+)=\"(/[^\"]+)\"$")
      set(name ${CMAKE_MATCH_1})
      cmake_path(SET path "${CMAKE_MATCH_2}")
      cmake_path(IS_PREFIX PROJECT_SOURCE_DIR "${path}" in_sources)
      cmake_path(IS_PREFIX PROJECT_BINARY_DIR "${path}" is_built)
      if(in_sources OR is_built)
        file(RELATIVE_PATH path ${CMAKE_CURRENT_BINARY_DIR} ${path})
        set(definition "${name}=\"./${path}\"")
      endif()
    endif()
    target_compile_definitions(${target} PRIVATE ${definition})
  endforeach()
endfunction()

# fovea_test(layer.subject SOURCES ... LIBS ... [TIMEOUT s] [LABELS extra...] [DEFINES ...])
# One process per program; the layer (text before the first dot) becomes a label.
function(fovea_test name)
  cmake_parse_arguments(A "" "TIMEOUT" "SOURCES;LIBS;LABELS;DEFINES" ${ARGN})
  if(NOT A_TIMEOUT)
    set(A_TIMEOUT 120)
  endif()
  string(REGEX REPLACE "\\..*" "" layer ${name})
  string(REPLACE "." "_" target test_${name})
  add_executable(${target} ${A_SOURCES})
  target_link_libraries(${target} PRIVATE ${A_LIBS} GTest::gmock GTest::gtest fovea_warnings)
  fovea_test_paths(${target} ${A_DEFINES})
  add_test(NAME ${name} COMMAND ${target})
  set_tests_properties(${name} PROPERTIES TIMEOUT ${A_TIMEOUT} LABELS "${layer};${A_LABELS}")
endfunction()
