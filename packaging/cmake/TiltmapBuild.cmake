# What every target of the project shares: warnings, sanitizers, coverage, compiler cache, linker.
include(CheckCXXCompilerFlag)

set(TILTMAP_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them: address,undefined or thread")
option(TILTMAP_WERROR "Treat warnings as errors" OFF)
option(TILTMAP_COVERAGE "Instrument for gcov" OFF)

find_program(TILTMAP_CCACHE ccache)
if(TILTMAP_CCACHE)
  # Without these two the cache keeps nothing that was compiled with precompiled headers.
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${TILTMAP_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_C_COMPILER_LAUNCHER})
endif()
find_program(TILTMAP_MOLD mold)
if(TILTMAP_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

# Carried by every room; foreign headers come in as SYSTEM and stay quiet.
add_library(tiltmap_build_flags INTERFACE)
target_compile_options(tiltmap_build_flags INTERFACE -Wall -Wextra -Wconversion -Wshadow
  # Eigen and the standard library trip this one inside inlined code of theirs.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
  # g++ 12 invents overlaps in "text" + std::to_string(n) (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(TILTMAP_WERROR)
  target_compile_options(tiltmap_build_flags INTERFACE -Werror)
endif()
# Multiplying and adding in one rounding would make results differ between machines.
target_compile_options(tiltmap_build_flags INTERFACE -ffp-contract=off)
if(TILTMAP_SANITIZE)
  target_compile_options(tiltmap_build_flags INTERFACE -fsanitize=${TILTMAP_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(tiltmap_build_flags INTERFACE -fsanitize=${TILTMAP_SANITIZE})
endif()
# Every program, for its leak report's sake.
add_library(tiltmap_program INTERFACE)
if(TILTMAP_SANITIZE MATCHES "address")
  add_library(tiltmap_keep_libraries OBJECT ${CMAKE_CURRENT_LIST_DIR}/keep_libraries.cpp)
  target_link_libraries(tiltmap_keep_libraries PRIVATE tiltmap_build_flags)
  target_sources(tiltmap_program INTERFACE $<TARGET_OBJECTS:tiltmap_keep_libraries>)
endif()
if(TILTMAP_COVERAGE)
  target_compile_options(tiltmap_build_flags INTERFACE --coverage -O0)
  target_link_options(tiltmap_build_flags INTERFACE --coverage)
endif()

# For what is not worth a compiler's effort: commands, whose work is done in core, and tests.
function(tiltmap_optimise_little target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# What most files of a room include, parsed once for each target. Every file still includes what it uses; the dev preset
# builds without precompiled headers, so that it shows.
set(TILTMAP_COMMON_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <limits> <map>
  <memory> <mutex> <numbers> <optional> <set> <span> <stdexcept> <stop_token> <string> <string_view> <thread> <utility>
  <variant> <vector> <Eigen/Dense> <tl/expected.hpp>)
set(TILTMAP_QT_HEADERS <QAbstractTableModel> <QColor> <QFileInfo> <QImage> <QObject> <QPainter> <QString>
  <QStringList> <QTimer>)
set(TILTMAP_WIDGET_HEADERS ${TILTMAP_QT_HEADERS} <QAction> <QApplication> <QComboBox> <QDialog> <QDoubleSpinBox>
  <QGridLayout> <QHeaderView> <QKeyEvent> <QLabel> <QLineEdit> <QMouseEvent> <QPushButton> <QToolButton> <QVBoxLayout>)
function(tiltmap_precompile target)
  target_precompile_headers(${target} PRIVATE ${TILTMAP_COMMON_HEADERS} ${ARGN})
endfunction()

# tiltmap_add_tests(NAME SOURCES... [LINKS lib...] [OWN_MAIN] [ALONE]): one GoogleTest program, its tests known to CTest.
# OWN_MAIN: a main() is among the sources. ALONE: with nothing beside it, where instruments are emulated in real time.
function(tiltmap_add_tests name)
  cmake_parse_arguments(ARG "OWN_MAIN;ALONE" "TIMEOUT" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(TILTMAP_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 6")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE tiltmap_build_flags tiltmap_program ${ARG_LINKS} GTest::gmock GTest::gtest
    $<$<NOT:$<BOOL:${ARG_OWN_MAIN}>>:GTest::gtest_main>)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE TILTMAP_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/bin)
  tiltmap_optimise_little(${name})
  list(LENGTH ARG_SOURCES files)
  if(files GREATER 2)
    set(qt_headers)
    if("tiltmap_ui" IN_LIST ARG_LINKS)
      set(qt_headers ${TILTMAP_WIDGET_HEADERS})
    elseif(name MATCHES "^test_ui_")
      set(qt_headers ${TILTMAP_QT_HEADERS})
    endif()
    tiltmap_precompile(${name} <gtest/gtest.h> <nlohmann/json.hpp> ${qt_headers})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES TIMEOUT ${ARG_TIMEOUT} RUN_SERIAL ${ARG_ALONE} ENVIRONMENT
      "TILTMAP_PROGRAM=$<TARGET_FILE:tiltmap>;LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0")
endfunction()
