#include <busbar/core/text.hpp>

#include "project_fields.hpp"

namespace busbar::controller {

namespace {

/// Sets the one value of a section that has this name.
class ValueSetter {
public:
    ValueSetter(std::string_view name, std::string_view value) : name_{name}, value_{value} {}

    void text(std::string_view name, std::string& to)
    {
        if (is_it(name)) {
            to = value_;
        }
    }
    void flag(std::string_view name, bool& to) { set(name, to); }
    void number(std::string_view name, std::uint32_t& to) { set(name, to); }
    void list(std::string_view name, std::vector<std::string>& to) { set(name, to); }
    template <typename T, std::size_t count>
    void choice(std::string_view name, T& to, const detail::Choices<T, count>& choices)
    {
        if (is_it(name)) {
            expected_ = detail::read_value(value_, to, choices);
        }
    }

    [[nodiscard]] bool is_found() const { return is_found_; }
    /// Empty if the value was set.
    [[nodiscard]] const std::string& expected() const { return expected_; }

private:
    template <typename T>
    void set(std::string_view name, T& to)
    {
        if (is_it(name)) {
            expected_ = detail::read_value(value_, to);
        }
    }
    bool is_it(std::string_view name)
    {
        is_found_ = is_found_ || name == name_;
        return name == name_;
    }

    std::string_view name_;
    std::string_view value_;
    std::string expected_;
    bool is_found_{false};
};

/// Parses "listener 2" as index 1; nothing if it is not of `kind`.
std::optional<std::size_t> index_in(std::string_view section, std::string_view kind)
{
    std::uint32_t number = 0;
    const bool is_kind = section.starts_with(kind) && section.size() > kind.size() + 1 &&
                         section[kind.size()] == ' ' &&
                         detail::read_value(section.substr(kind.size() + 1), number).empty() &&
                         number > 0;
    return is_kind ? std::optional<std::size_t>{number - 1} : std::nullopt;
}

/// Removes the item, or has the visitor set a value in it; the index after the last creates a new
/// item.
template <typename T, typename Visit>
Configured<void> set_item(std::vector<T>& items, std::size_t index, std::string_view section,
                          ValueSetter* setter, Visit visit)
{
    if (index >= items.size() + (setter != nullptr ? 1U : 0U)) {
        return misconfigured(std::string{section}, "found " + std::to_string(items.size()) +
                                                       ", expected the number of one of them");
    }
    if (setter == nullptr) {
        items.erase(items.begin() + static_cast<std::ptrdiff_t>(index));
        return {};
    }
    T item = index < items.size() ? items[index] : T{};
    visit(*setter, item);
    if (!setter->is_found() || !setter->expected().empty()) {
        return {}; // the caller reports it
    }
    if (index < items.size()) {
        items[index] = std::move(item);
    } else {
        items.push_back(std::move(item));
    }
    return {};
}

Configured<void> set_in_section(Project& project, std::string_view section, ValueSetter* setter)
{
    if (const auto index = index_in(section, "listener")) {
        return set_item(project.network.listeners, *index, section, setter,
                        [](auto& visitor, auto& item) { detail::visit_listener(visitor, item); });
    }
    if (const auto index = index_in(section, "user")) {
        return set_item(project.users, *index, section, setter,
                        [](auto& visitor, auto& item) { detail::visit_user(visitor, item); });
    }
    if (setter != nullptr && section.empty()) {
        detail::visit_project(*setter, project);
    } else if (setter != nullptr) {
        detail::for_each_section([&](std::string_view title, auto visit) {
            if (title == section) {
                visit(*setter, project);
            }
        });
    }
    return {};
}

} // namespace

Configured<void> set_project_value(Project& project, std::string_view name, std::string_view value)
{
    const std::size_t point = name.find('.');
    const bool has_index = index_in(name, "listener") || index_in(name, "user");
    if (value.empty() && has_index) {
        return set_in_section(project, name, nullptr);
    }
    const std::string_view section =
        point == std::string_view::npos ? std::string_view{} : name.substr(0, point);
    if (!detail::is_project_text(value)) {
        return misconfigured(
            printable(name),
            "found control characters or bytes that are not UTF-8, expected text of one line");
    }
    ValueSetter setter{point == std::string_view::npos ? name : name.substr(point + 1), value};
    if (auto set = set_in_section(project, section, &setter); !set) {
        return set;
    }
    if (!setter.is_found()) {
        return misconfigured(printable(name), "is not a value of a project");
    }
    if (!setter.expected().empty()) {
        return misconfigured(printable(name), "found \"" + printable(value, 64) + "\", expected " +
                                                  setter.expected());
    }
    return {};
}

} // namespace busbar::controller
