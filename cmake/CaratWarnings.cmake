# Warnings for our own code; errors where CARAT_WERROR asks for it (CI does).
function(carat_warnings target)
  target_compile_options(
    ${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align
                      -Wunused -Woverloaded-virtual -Wdouble-promotion
                      $<$<BOOL:${CARAT_WERROR}>:-Werror>)
endfunction()
