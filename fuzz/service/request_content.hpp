#pragma once

#include <cstdint>
#include <random>
#include <string_view>

#include <busbar/binary/dynamic_value.hpp>

namespace busbar::fuzz {

/// Fills requests with what a server may take: nodes that there are, small ids, filters, ranges and
/// values of its Variables, and now and then anything else.
class RequestContent {
public:
    explicit RequestContent(std::uint32_t seed) : random_{seed} {}

    /// A value of a structure or union.
    [[nodiscard]] binary::DynamicValue structure(const binary::DynamicType& type,
                                                 unsigned depth = 0);
    /// Gives one field, or one within it, other content.
    void change(binary::DynamicValue& value, unsigned depth = 0);
    [[nodiscard]] std::size_t below(std::size_t count) { return random_() % count; }

private:
    void fill(binary::DynamicValue& value, std::size_t field, unsigned depth);
    void change_array(binary::DynamicValue& value, std::size_t field, unsigned depth);
    [[nodiscard]] Variant content(const binary::DynamicField& field, unsigned depth);
    template <typename T>
    [[nodiscard]] T one(const binary::DynamicField& field, unsigned depth);

    [[nodiscard]] bool once_in(std::size_t count) { return below(count) == 0; }
    template <typename Choices>
    [[nodiscard]] auto one_of(const Choices& choices)
    {
        return choices[below(choices.size())];
    }
    [[nodiscard]] std::uint32_t any_number() { return static_cast<std::uint32_t>(random_()); }
    [[nodiscard]] NodeId node();
    [[nodiscard]] std::uint32_t number(std::string_view name);
    [[nodiscard]] std::int32_t enumeration(const binary::DynamicField& field);
    [[nodiscard]] String text(std::string_view name);
    [[nodiscard]] ByteString bytes(std::string_view name);
    [[nodiscard]] Variant any();
    [[nodiscard]] ExtensionObject object(unsigned depth);

    std::mt19937 random_;
};

} // namespace busbar::fuzz
