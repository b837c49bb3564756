# find_package(backstop) defines
#   backstop::backstop  the shared library
#   backstop::static    the static library, with what it needs of the system
get_filename_component(_backstop_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET backstop::backstop)
    add_library(backstop::backstop SHARED IMPORTED)
    set_target_properties(backstop::backstop PROPERTIES
        IMPORTED_LOCATION "${_backstop_prefix}/lib/@SHARED@"
        IMPORTED_SONAME "@SONAME@"
        INTERFACE_INCLUDE_DIRECTORIES "${_backstop_prefix}/include")
    add_library(backstop::static STATIC IMPORTED)
    set_target_properties(backstop::static PROPERTIES
        IMPORTED_LOCATION "${_backstop_prefix}/lib/libbackstop_c.a"
        INTERFACE_LINK_LIBRARIES "@SYSTEM@"
        INTERFACE_INCLUDE_DIRECTORIES "${_backstop_prefix}/include")
endif()

unset(_backstop_prefix)
