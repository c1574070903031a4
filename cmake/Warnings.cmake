# Warnings for our own targets; errors only where NOCTULE_WARNINGS_AS_ERRORS is on (dev preset), so that a newer
# compiler never stops a user's build.
option(NOCTULE_WARNINGS_AS_ERRORS "treat warnings of Noctule's own targets as errors" OFF)

add_library(noctule_warnings INTERFACE)
target_compile_options(noctule_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                                  -Wnon-virtual-dtor -Woverloaded-virtual
                                                  # g++ 12 sees overlapping copies in "a" + std::string (GCC bug 105651).
                                                  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                                                  $<$<BOOL:${NOCTULE_WARNINGS_AS_ERRORS}>:-Werror>)
