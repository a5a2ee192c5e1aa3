#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/core/attribute_id.hpp>
#include <busbar/model/node.hpp>

#include "core/ascii_case.hpp"
#include "core/utf8.hpp"
#include "record.hpp"

namespace busbar::model::detail {

/// A text of one attribute in another locale than its first.
struct Translation {
    AttributeId attribute;
    LocalizedText text;
};

/// LocaleIds are compared without case (Part 3, 8.4; RFC 5646, 2.1.1).
[[nodiscard]] inline bool is_same_locale(std::string_view a, std::string_view b)
{
    return busbar::detail::is_same_ignoring_case(a, b);
}

/// Returns whether both parts are UTF-8 (Part 6, 5.2.2.4).
[[nodiscard]] inline bool is_valid_text(const LocalizedText& text)
{
    return busbar::detail::is_valid_text(text.locale.view()) &&
           busbar::detail::is_valid_text(text.text.view());
}

/// Texts in further locales than the first, by node; few nodes have any.
class Translations {
public:
    [[nodiscard]] bool empty() const { return entries_.empty(); }
    /// The texts of all its attributes, in the order of addition; valid until one of the node
    /// changes.
    [[nodiscard]] std::span<const Translation> of(NodeIndex node) const;
    /// Adds or replaces the text in its locale.
    void set(NodeIndex node, AttributeId attribute, LocalizedText text);
    /// Removes and returns the first text; null if there is none.
    [[nodiscard]] LocalizedText take_first(NodeIndex node, AttributeId attribute);
    void erase(NodeIndex node, AttributeId attribute, std::string_view locale);
    void erase(NodeIndex node, AttributeId attribute);
    void erase(NodeIndex node) { entries_.erase(number(node)); }
    /// Removes and returns all texts of the node; `put` restores them.
    [[nodiscard]] std::vector<Translation> take(NodeIndex node);
    void put(NodeIndex node, std::vector<Translation> texts);
    /// All locales that were ever set, each once.
    [[nodiscard]] std::span<const std::string> locales() const { return locales_; }

private:
    template <typename Match>
    void erase_if(NodeIndex node, Match match);

    std::unordered_map<std::uint32_t, std::vector<Translation>> entries_;
    std::vector<std::string> locales_;
};

} // namespace busbar::model::detail
