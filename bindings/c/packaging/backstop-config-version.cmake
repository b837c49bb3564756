# A program that asks for version A.B gets A.B or later with the same A, and before 1.0 with the same B.
set(PACKAGE_VERSION "@VERSION@")
string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" _backstop_has "${PACKAGE_VERSION}")
set(_backstop_major "${CMAKE_MATCH_1}")
set(_backstop_minor "${CMAKE_MATCH_2}")

set(PACKAGE_VERSION_COMPATIBLE TRUE)
if(PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)
    set(PACKAGE_VERSION_COMPATIBLE FALSE)
elseif(PACKAGE_FIND_VERSION_COUNT GREATER 0 AND NOT PACKAGE_FIND_VERSION_MAJOR EQUAL _backstop_major)
    set(PACKAGE_VERSION_COMPATIBLE FALSE)
elseif(_backstop_major EQUAL 0 AND PACKAGE_FIND_VERSION_COUNT GREATER 1
        AND NOT PACKAGE_FIND_VERSION_MINOR EQUAL _backstop_minor)
    set(PACKAGE_VERSION_COMPATIBLE FALSE)
endif()
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
endif()
# The libraries are of one size of pointers.
if(CMAKE_SIZEOF_VOID_P AND NOT CMAKE_SIZEOF_VOID_P EQUAL @POINTER@)
    set(PACKAGE_VERSION_UNSUITABLE TRUE)
endif()

unset(_backstop_has)
unset(_backstop_major)
unset(_backstop_minor)
