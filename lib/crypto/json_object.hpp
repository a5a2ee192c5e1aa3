#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace busbar::crypto::detail {

/// What JSON Web Tokens need of JSON, and no more: the members of one object. Written here since
/// the JSON libraries at hand throw, or allocate what a stranger asks for; this reader is strict
/// and its memory is bounded by the text's size.
///
/// Of RFC 8259, refused besides what is not JSON: a member that is there twice (RFC 7519, 4), NUL
/// in a string, a half of a surrogate pair, nesting past 8 and more than 64 members.
class JsonObject {
public:
    /// Stands for true, false, null, objects and arrays of anything but strings.
    struct Other {};
    using Strings = std::vector<std::string>;
    using Value = std::variant<Other, std::string, double, Strings>;

    /// Nothing unless `text` is one object with white space around.
    [[nodiscard]] static std::optional<JsonObject> parse(std::string_view text);

    [[nodiscard]] bool has(std::string_view name) const { return find<Value>(name) != nullptr; }
    /// The member's value if it is there and a T; T may be Value.
    template <typename T>
    [[nodiscard]] const T* find(std::string_view name) const
    {
        for (const auto& [key, value] : members_) {
            if (key == name) {
                if constexpr (std::is_same_v<T, Value>) {
                    return &value;
                } else {
                    return std::get_if<T>(&value);
                }
            }
        }
        return nullptr;
    }

private:
    std::vector<std::pair<std::string, Value>> members_;
};

} // namespace busbar::crypto::detail
