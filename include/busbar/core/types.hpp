#pragma once

// The built-in types of OPC UA (Part 6, 5.1.2).

#include <busbar/core/array.hpp>            // IWYU pragma: export
#include <busbar/core/built_in_type.hpp>    // IWYU pragma: export
#include <busbar/core/data_value.hpp>       // IWYU pragma: export
#include <busbar/core/date_time.hpp>        // IWYU pragma: export
#include <busbar/core/diagnostic_info.hpp>  // IWYU pragma: export
#include <busbar/core/extension_object.hpp> // IWYU pragma: export
#include <busbar/core/guid.hpp>             // IWYU pragma: export
#include <busbar/core/node_id.hpp>          // IWYU pragma: export
#include <busbar/core/result.hpp>           // IWYU pragma: export
#include <busbar/core/string.hpp>           // IWYU pragma: export
#include <busbar/core/text.hpp>             // IWYU pragma: export
#include <busbar/core/variant.hpp>          // IWYU pragma: export
