# What neither core nor firmware may hold: heap, exceptions, guarded statics. A pattern for whole names,
# which symbols_of() gives.
set(forbidden_symbols
    "(malloc|free|calloc|realloc|posix_memalign|aligned_alloc|memalign|valloc"
    "|_malloc_r|_free_r|_calloc_r|_realloc_r|_sbrk|_sbrk_r"
    "|_Zn[wa][^ ()\n]*|_Zd[la][^ ()\n]*" # operator new, operator delete
    "|__cxa_(throw|rethrow|allocate_exception|bad_cast|bad_typeid|guard_|atexit)[^ ()\n]*"
    "|_ZSt[^ ()\n]*throw[^ ()\n]*|_Unwind_[^ ()\n]*|__gxx_personality[^ ()\n]*)")
string(JOIN "" forbidden_symbols ${forbidden_symbols})

# symbols_of(<nm> <file> <variable> [<option of nm>...]): names of the symbols in an object or image.
function(symbols_of nm file variable)
  execute_process(COMMAND "${nm}" ${ARGN} --format=posix "${file}" OUTPUT_VARIABLE text
                  RESULT_VARIABLE outcome ERROR_VARIABLE complaint)
  if(NOT outcome EQUAL 0)
    message(FATAL_ERROR "${nm} ${file}: ${complaint}")
  endif()
  string(REGEX MATCHALL "[^\n]+" lines "${text}")
  list(TRANSFORM lines REPLACE "[ @].*" "")
  set(${variable} "${lines}" PARENT_SCOPE)
endfunction()
