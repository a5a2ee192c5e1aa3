#include <busbar/administration/setting_list.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>

#include "json_file.hpp"
#include "setting_values.hpp"

namespace busbar::administration {

namespace {

constexpr std::uint32_t settings_version = 1;
constexpr std::size_t max_elements = 1'000;
constexpr std::size_t max_text = 65'536;
/// Maximum size of the file, which must be readable again.
constexpr std::size_t max_settings_size = 4U << 20U;

Unexpected<Problem> wrong_value(const Setting& setting, const Variant& value, std::string expected,
                                StatusCode status)
{
    return misconfigured(setting.name,
                         "found " + detail::shown(value) + ", expected " + std::move(expected),
                         status);
}

std::string text_of(double number)
{
    constexpr double exact = 9'007'199'254'740'992; // whole numbers up to it are written as such
    if (number == std::floor(number) && std::abs(number) <= exact) {
        return std::to_string(static_cast<std::int64_t>(number));
    }
    detail::JsonWriter json;
    detail::write_value(json, Variant{number});
    return json.take();
}

template <typename T>
bool is_within(const Variant& value, const Range& range)
{
    const auto fits = [&](T number) {
        return static_cast<double>(number) >= range.low &&
               static_cast<double>(number) <= range.high;
    };
    const Array<T>* const list = value.array_if<T>();
    const T* const one = value.get_if<T>();
    return (one == nullptr || fits(*one)) &&
           (list == nullptr || std::all_of(list->begin(), list->end(), fits));
}

bool is_finite(const Variant& value)
{
    const auto* const list = value.array_if<double>();
    const auto* const one = value.get_if<double>();
    return (one == nullptr || std::isfinite(*one)) &&
           (list == nullptr || std::all_of(list->begin(), list->end(),
                                           [](double each) { return std::isfinite(each); }));
}

bool is_short(const Variant& value)
{
    const auto fits = [](const String& text) {
        return text.view().size() <= max_text && detail::is_kept_whole(text.view());
    };
    const auto* const list = value.array_if<String>();
    const auto* const one = value.get_if<String>();
    return value.array_size() <= max_elements && (one == nullptr || fits(*one)) &&
           (list == nullptr || std::all_of(list->begin(), list->end(), fits));
}

/// Copies a value with texts of its own, because a request may have lent them.
Variant own_copy(const Variant& value)
{
    if (const auto* const text = value.get_if<String>()) {
        return Variant{String{text->str()}};
    }
    if (const auto* const list = value.array_if<String>()) {
        Array<String> own;
        own.clear();
        for (const String& text : *list) {
            own.push_back(String{text.str()});
        }
        return Variant{std::move(own)};
    }
    return value;
}

void write_authors(detail::JsonWriter& json, const SettingAuthors& authors)
{
    if (authors.empty()) {
        return;
    }
    json.name("authors");
    json.begin_object();
    for (const auto& [name, author] : authors) {
        json.name(name);
        json.begin_object();
        json.name("user");
        json.string(author.user);
        json.name("time");
        json.string(to_string(author.time));
        json.end_object();
    }
    json.end_object();
}

/// Reads the authors of these changes. Ignores those that cannot be read: an unknown author must
/// not lose a change.
SettingAuthors authors_in(const detail::Json& document, const SettingValues& changes)
{
    SettingAuthors authors;
    const detail::Json* const all = document.find("authors");
    for (const auto& [name, value] : changes) {
        const detail::Json* const author = all != nullptr ? all->find(name) : nullptr;
        const std::string* const user =
            author != nullptr ? detail::text_of(*author, "user") : nullptr;
        const std::string* const time =
            author != nullptr ? detail::text_of(*author, "time") : nullptr;
        const auto parsed = time != nullptr ? parse_date_time(*time) : std::nullopt;
        if (user != nullptr && parsed) {
            authors.emplace(name, SettingAuthor{printable(*user), *parsed});
        }
    }
    return authors;
}

} // namespace

std::string settings_document(const SettingValues& changes, const SettingAuthors& authors)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("version");
    json.word(std::to_string(settings_version));
    json.name("settings");
    json.begin_object();
    for (const auto& [name, value] : changes) {
        json.name(name);
        detail::write_value(json, value);
    }
    json.end_object();
    write_authors(json, authors);
    json.end_object();
    return json.take() + "\n";
}

Configured<void> check_setting(const Setting& setting, const Variant& value)
{
    const Variant& like = setting.otherwise;
    if (value.type() != like.type() || value.is_array() != like.is_array() || value.is_matrix() ||
        !is_finite(value)) {
        return wrong_value(setting, value, detail::kind_of(like), status::Bad_TypeMismatch);
    }
    if (!is_short(value)) {
        return misconfigured(setting.name,
                             "found more than " + std::to_string(max_elements) +
                                 " elements, or a text of more than " + std::to_string(max_text) +
                                 " bytes or not UTF-8",
                             status::Bad_OutOfRange);
    }
    const auto& range = setting.range;
    if (range && !(is_within<std::int64_t>(value, *range) && is_within<double>(value, *range))) {
        return wrong_value(setting, value,
                           text_of(range->low) + " to " + text_of(range->high) +
                               (setting.unit.empty() ? "" : " " + setting.unit),
                           status::Bad_OutOfRange);
    }
    return {};
}

SettingList::SettingList(Storage& storage, std::string file, std::vector<Setting> settings)
    : storage_{&storage}, file_{std::move(file)}, settings_{std::move(settings)}
{
    std::sort(settings_.begin(), settings_.end(),
              [](const Setting& a, const Setting& b) { return a.name < b.name; });
}

const Setting* SettingList::find(std::string_view name) const
{
    const auto found =
        std::lower_bound(settings_.begin(), settings_.end(), name,
                         [](const Setting& each, std::string_view n) { return each.name < n; });
    return found != settings_.end() && found->name == name ? &*found : nullptr;
}

Configured<void> SettingList::load()
{
    const auto json = detail::read_json_file(*storage_, file_, settings_version);
    if (!json) {
        return Unexpected{json.error()};
    }
    if (!*json) {
        changes_.clear();
        authors_.clear();
        return {};
    }
    const auto* const all = (*json)->find("settings");
    const auto wrong = [&](const std::string& member, const detail::Json* found,
                           std::string_view expected) {
        return Unexpected{
            detail::wrong_member(*storage_, file_, "settings" + member, found, expected)};
    };
    if (all == nullptr || all->kind != detail::Json::Kind::Object) {
        return wrong("", all, "an object");
    }
    SettingValues changes;
    for (std::size_t i = 0; i < all->items.size(); ++i) {
        const std::string& name = all->names[i];
        const Setting* const setting = find(name);
        if (setting == nullptr) {
            return wrong("." + name, &all->items[i], "the name of a setting");
        }
        auto value = detail::value_of(all->items[i], setting->otherwise);
        if (!value) {
            return wrong("." + name, &all->items[i], detail::kind_of(setting->otherwise));
        }
        if (auto checked = check_setting(*setting, *value); !checked) {
            checked.error().where = storage_->place(file_) + ": settings." + name;
            return checked;
        }
        changes.emplace(name, *std::move(value));
    }
    authors_ = authors_in(**json, changes);
    changes_ = std::move(changes);
    return {};
}

Configured<void> SettingList::forget()
{
    const auto removed = storage_->remove(file_);
    if (!removed && removed.error() != StorageError::NotFound) {
        return misconfigured(storage_->place(file_), std::string{text(removed.error())},
                             status_of(removed.error()));
    }
    changes_.clear();
    authors_.clear();
    return {};
}

Configured<void> SettingList::change(std::span<const SettingChange> set, SettingOwner& owner,
                                     const SettingAuthor& author)
{
    SettingValues changes = changes_;
    SettingAuthors authors = authors_;
    for (const SettingChange& each : set) {
        const Setting* const setting = find(each.name);
        if (setting == nullptr) {
            return misconfigured(each.name, "there is no such setting", status::Bad_NotFound);
        }
        if (each.value.is_null()) {
            changes.erase(each.name);
            authors.erase(each.name);
            continue;
        }
        if (auto checked = check_setting(*setting, each.value); !checked) {
            return checked;
        }
        changes.insert_or_assign(each.name, own_copy(each.value));
        if (author == SettingAuthor{}) {
            authors.erase(each.name);
        } else {
            authors.insert_or_assign(each.name, SettingAuthor{printable(author.user), author.time});
        }
    }
    if (auto checked = owner.check(changes); !checked) {
        if (checked.error().status != status::Bad_InvalidState) {
            checked.error().status = status::Bad_InvalidArgument;
        }
        return checked;
    }
    const std::string document = settings_document(changes, authors);
    if (document.size() > max_settings_size) {
        return misconfigured(file_, "found more than can be kept", status::Bad_OutOfRange);
    }
    const auto written =
        storage_->replace(file_, std::as_bytes(std::span{document}), FileAccess::Owner);
    if (!written) {
        return misconfigured(storage_->place(file_), std::string{text(written.error())},
                             status_of(written.error()));
    }
    changes_ = std::move(changes);
    authors_ = std::move(authors);
    owner.apply(changes_);
    return {};
}

} // namespace busbar::administration
