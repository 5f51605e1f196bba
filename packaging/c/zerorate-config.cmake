# find_package(zerorate) gives zerorate::zerorate: driver, correction and procedure for C.
# An image stays small with -ffunction-sections and -Wl,--gc-sections.
if(NOT TARGET zerorate::zerorate)
    get_filename_component(zerorate_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
    add_library(zerorate::zerorate STATIC IMPORTED)
    set_target_properties(zerorate::zerorate PROPERTIES
        IMPORTED_LOCATION "${zerorate_prefix}/lib/libzerorate_c.a"
        IMPORTED_LINK_INTERFACE_LANGUAGES C
        INTERFACE_INCLUDE_DIRECTORIES "${zerorate_prefix}/include")
    unset(zerorate_prefix)
endif()
