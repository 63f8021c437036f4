# Runs fastddsgen once. It returns 0 even when its templates fail, so its output is read; object hashes in its
# comments are stripped to keep builds reproducible; its scratch files are kept apart from those of other builds.
file(MAKE_DIRECTORY ${OUT}/scratch)
execute_process(COMMAND ${FASTDDSGEN} -replace -d ${OUT} -t ${OUT}/scratch ${OPTIONS} ${IDL} RESULT_VARIABLE result OUTPUT_VARIABLE log
                ERROR_VARIABLE log)
if(NOT result EQUAL 0 OR log MATCHES "ERROR|rror:")
  message(FATAL_ERROR "fastddsgen failed on ${IDL}:\n${log}")
endif()
file(GLOB files ${OUT}/*.h ${OUT}/*.hpp ${OUT}/*.ipp ${OUT}/*.cxx)
foreach(file ${files})
  file(READ ${file} text)
  string(REGEX REPLACE "com\\.eprosima[A-Za-z0-9_.$]*@[0-9a-f]+" "" stripped "${text}")
  if(NOT stripped STREQUAL text)
    file(WRITE ${file} "${stripped}")
  endif()
endforeach()
