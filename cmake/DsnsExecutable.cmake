# dsns_executable(TARGET): how the project builds its own tests, examples and benchmarks. Nothing of it reaches users.
add_library(dsns_build_options INTERFACE)
target_compile_options(dsns_build_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wdouble-promotion -Wnon-virtual-dtor -Wold-style-cast)
# Eigen's own threads fight with ours.
target_compile_definitions(dsns_build_options INTERFACE EIGEN_DONT_PARALLELIZE)
if(DSNS_WARNINGS_AS_ERRORS)
  target_compile_options(dsns_build_options INTERFACE -Werror)
endif()
if(DSNS_NATIVE)
  include(CheckCXXCompilerFlag)
  check_cxx_compiler_flag(-march=native DSNS_HAS_MARCH_NATIVE)
  if(DSNS_HAS_MARCH_NATIVE)
    target_compile_options(dsns_build_options INTERFACE -march=native)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(dsns_build_options INTERFACE -Wno-maybe-uninitialized)  # in g++ 12's own AVX-512 headers
    endif()
  endif()
endif()
if(DSNS_SANITIZE)
  # Not at every memory access once more what the address sanitizer (null, object size, wild pointers) and Eigen's own
  # assertions (alignment) find: it takes longer to compile than all the rest.
  set(sanitize -fsanitize=address,undefined -fno-sanitize=null,vptr,alignment,object-size,pointer-overflow
    -fno-sanitize-recover=all)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Calls in large functions: less code to compile, the same checks. In small ones they double the time of the tests.
    list(APPEND sanitize "SHELL:-mllvm -asan-instrumentation-with-call-threshold=100")
  endif()
  target_compile_options(dsns_build_options INTERFACE ${sanitize} -fno-omit-frame-pointer)
  target_link_options(dsns_build_options INTERFACE -fsanitize=address,undefined)
endif()

function(dsns_executable target)
  target_link_libraries(${target} PRIVATE dsns_build_options)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()
