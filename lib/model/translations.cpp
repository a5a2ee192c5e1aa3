#include "translations.hpp"

#include <algorithm>
#include <utility>

#include <busbar/model/address_space.hpp>

#include "tables.hpp"

namespace busbar::model {

namespace detail {

namespace {

std::string_view language_of(std::string_view locale)
{
    return locale.substr(0, locale.find('-'));
}

/// Part 4, 5.7.3: compares the locale itself, or at least its language.
bool fits(std::string_view locale, std::string_view wanted, bool is_exact)
{
    return is_exact ? is_same_locale(locale, wanted)
                    : !locale.empty() && is_same_locale(language_of(locale), language_of(wanted));
}

/// Returns the text that comes first in the order of `locales`; null if that is `first`, or if
/// there is none in any of them.
const LocalizedText* best(const LocalizedText& first, std::span<const Translation> further,
                          AttributeId attribute, std::span<const std::string> locales)
{
    for (const bool is_exact : {true, false}) {
        for (const std::string& wanted : locales) {
            if (wanted.empty()) {
                continue;
            }
            if (fits(first.locale.view(), wanted, is_exact)) {
                return nullptr;
            }
            const auto found = std::find_if(further.begin(), further.end(), [&](const auto& each) {
                return each.attribute == attribute &&
                       fits(each.text.locale.view(), wanted, is_exact);
            });
            if (found != further.end()) {
                return &found->text;
            }
        }
    }
    return nullptr;
}

/// Returns a copy that owns its texts; an empty text becomes null.
LocalizedText owned(const LocalizedText& text)
{
    return {text.locale.empty() ? String{} : String{text.locale.view()},
            text.text.empty() ? String{} : String{text.text.view()}};
}

} // namespace

std::span<const Translation> Translations::of(NodeIndex node) const
{
    const auto found = entries_.find(number(node));
    return found == entries_.end() ? std::span<const Translation>{} : found->second;
}

void Translations::set(NodeIndex node, AttributeId attribute, LocalizedText text)
{
    const std::string_view locale = text.locale.view();
    if (!locale.empty() &&
        std::none_of(locales_.begin(), locales_.end(),
                     [&](const std::string& known) { return is_same_locale(known, locale); })) {
        locales_.emplace_back(locale);
    }
    std::vector<Translation>& all = entries_[number(node)];
    const auto found = std::find_if(all.begin(), all.end(), [&](const Translation& each) {
        return each.attribute == attribute && is_same_locale(each.text.locale.view(), locale);
    });
    if (found != all.end()) {
        found->text = std::move(text);
    } else {
        all.push_back({attribute, std::move(text)});
    }
}

template <typename Match>
void Translations::erase_if(NodeIndex node, Match match)
{
    const auto found = entries_.find(number(node));
    if (found == entries_.end()) {
        return;
    }
    std::erase_if(found->second, match);
    if (found->second.empty()) {
        entries_.erase(found);
    }
}

LocalizedText Translations::take_first(NodeIndex node, AttributeId attribute)
{
    const auto all = entries_.find(number(node));
    if (all == entries_.end()) {
        return {};
    }
    std::vector<Translation>& texts = all->second;
    const auto found = std::find_if(texts.begin(), texts.end(), [&](const Translation& each) {
        return each.attribute == attribute;
    });
    if (found == texts.end()) {
        return {};
    }
    LocalizedText taken = std::move(found->text);
    texts.erase(found);
    if (texts.empty()) {
        entries_.erase(all);
    }
    return taken;
}

void Translations::erase(NodeIndex node, AttributeId attribute, std::string_view locale)
{
    erase_if(node, [&](const Translation& each) {
        return each.attribute == attribute && is_same_locale(each.text.locale.view(), locale);
    });
}

void Translations::erase(NodeIndex node, AttributeId attribute)
{
    erase_if(node, [&](const Translation& each) { return each.attribute == attribute; });
}

std::vector<Translation> Translations::take(NodeIndex node)
{
    const auto found = entries_.extract(number(node));
    return found.empty() ? std::vector<Translation>{} : std::move(found.mapped());
}

void Translations::put(NodeIndex node, std::vector<Translation> texts)
{
    if (!texts.empty()) {
        entries_.insert_or_assign(number(node), std::move(texts));
    }
}

} // namespace detail

namespace {

/// Returns the text of the attribute for all locales without one of their own.
LocalizedText first_text(const SpaceReader& space, NodeIndex node, AttributeId attribute)
{
    const Variant value = attribute == AttributeId::Value
                              ? space.value(node)
                              : space.attribute(node, attribute).value_or(Variant{});
    const auto* const text = value.get_if<LocalizedText>();
    return text == nullptr ? LocalizedText{} : detail::owned(*text);
}

/// Must not be called for the InverseName of a constant node.
void set_first(detail::Tables& tables, NodeIndex node, AttributeId attribute, LocalizedText text)
{
    if (tables.is_constant(node)) {
        detail::Overlay& overlay = tables.make_overlay(node);
        (attribute == AttributeId::DisplayName ? overlay.display_name : overlay.description) =
            std::move(text);
        return;
    }
    detail::Extra& extra = tables.record(node).make_extra();
    LocalizedText& to = attribute == AttributeId::DisplayName   ? extra.display_name
                        : attribute == AttributeId::Description ? extra.description
                                                                : extra.inverse_name;
    to = std::move(text);
}

} // namespace

void SpaceReader::translate(NodeIndex node, AttributeId attribute,
                            std::span<const std::string> locales, LocalizedText& text) const
{
    if (locales.empty() || tables_->translations.empty()) {
        return;
    }
    const auto further = tables_->translations.of(node);
    if (further.empty()) {
        return;
    }
    if (const LocalizedText* const found = detail::best(text, further, attribute, locales)) {
        text = {String::borrow(found->locale.view()), String::borrow(found->text.view())};
    }
}

std::vector<LocalizedText> SpaceReader::texts(NodeIndex node, AttributeId attribute) const
{
    std::vector<LocalizedText> all;
    if (LocalizedText first = first_text(*this, node, attribute); !first.text.empty()) {
        all.push_back(std::move(first));
    }
    for (const detail::Translation& each : tables_->translations.of(node)) {
        if (each.attribute == attribute) {
            all.push_back(each.text);
        }
    }
    return all;
}

bool SpaceReader::has_further_texts(NodeIndex node) const
{
    return !tables_->translations.of(node).empty();
}

std::span<const std::string> SpaceReader::further_locales() const
{
    return tables_->translations.locales();
}

Result<void> AddressSpace::set_text(NodeIndex node, AttributeId attribute, DataValue text)
{
    const auto* const sent = text.value.get_if<LocalizedText>();
    const bool is_value = attribute == AttributeId::Value;
    if (sent == nullptr) {
        return fail(status::Bad_TypeMismatch);
    }
    if (!detail::is_valid_text(*sent)) {
        return fail(status::Bad_EncodingError);
    }
    if (!has_attribute(node_class(node), attribute) ||
        (!is_value && attribute != AttributeId::DisplayName &&
         attribute != AttributeId::Description && attribute != AttributeId::InverseName)) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    LocalizedText first = first_text(*this, node, attribute);
    LocalizedText next = detail::owned(*sent);
    detail::Translations& further = tables_->translations;
    const bool is_for_all = next.locale.empty() && next.text.empty();
    const bool is_for_first =
        first.text.empty() || detail::is_same_locale(first.locale.view(), next.locale.view());
    if (attribute == AttributeId::InverseName && tables_->is_constant(node) &&
        (is_for_all || is_for_first)) {
        return fail(status::Bad_NotWritable);
    }
    if (is_for_all) {
        further.erase(node, attribute);
        first = {};
    } else if (is_for_first) {
        first = next.text.empty() ? further.take_first(node, attribute) : std::move(next);
    } else if (next.text.empty()) {
        further.erase(node, attribute, next.locale.view());
    } else {
        further.set(node, attribute, std::move(next));
    }
    if (!is_value) {
        set_first(*tables_, node, attribute, std::move(first));
        return {};
    }
    std::vector<detail::Translation> kept = further.take(node);
    text.value = Variant{std::move(first)};
    auto set = set_data_value(node, std::move(text));
    further.put(node, std::move(kept));
    return set;
}

void AddressSpace::set_display_name(NodeIndex node, LocalizedText text)
{
    if (!detail::is_valid_text(text)) {
        return;
    }
    tables_->translations.erase(node, AttributeId::DisplayName);
    set_first(*tables_, node, AttributeId::DisplayName, std::move(text));
}

void AddressSpace::set_description(NodeIndex node, LocalizedText text)
{
    if (!detail::is_valid_text(text)) {
        return;
    }
    tables_->translations.erase(node, AttributeId::Description);
    set_first(*tables_, node, AttributeId::Description, std::move(text));
}

} // namespace busbar::model
