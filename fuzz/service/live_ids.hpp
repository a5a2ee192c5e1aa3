#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/string.hpp>

namespace busbar::fuzz {

/// What a server has given an id while an input is played, the newest first: small numbers of a
/// request stand for these.
class LiveIds {
public:
    /// Puts them into a request. Numbers that are not that small stay.
    void bind(binary::DynamicValue& request) const;
    /// Takes those of a response.
    void learn(const binary::DynamicValue& response);
    void clear();

private:
    using Numbers = std::deque<std::uint32_t>;
    [[nodiscard]] const Numbers* numbers_of(std::string_view field) const;
    void bind_points(binary::DynamicValue& request) const;
    void learn_items(const binary::DynamicArray& results);
    void learn_points(const binary::DynamicArray& results);

    Numbers subscriptions_;
    Numbers items_;
    std::deque<ByteString> continuation_points_;
};

} // namespace busbar::fuzz
