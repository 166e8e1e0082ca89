# Writes the commit of the sources into OUTPUT, a header, where that is not what it says already: ", commit 1a2b3c4d5e" or
# nothing, where there is no repository. Run at every build, so that a commit alone changes what `--version` says.
cmake_policy(VERSION 3.25)
execute_process(COMMAND git -c safe.directory=* rev-parse --short=10 HEAD WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(commit)
  set(commit ", commit ${commit}")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define NEUVV_COMMIT \"@commit@\"\n" @ONLY)
