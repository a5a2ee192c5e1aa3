#pragma once

#include <string>
#include <string_view>

#include "core/json_writer.hpp"

namespace busbar::bench {

/// The text as a JSON string: a URL comes from whoever asks.
[[nodiscard]] inline std::string json_text(std::string_view text)
{
    busbar::detail::JsonWriter json;
    json.string(text);
    return json.take();
}

} // namespace busbar::bench
