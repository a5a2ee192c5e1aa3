#include <algorithm>
#include <span>

#include <busbar/controller/project.hpp>

#include "controller/life/checksum.hpp"
#include "project_fields.hpp"

namespace busbar::controller {

namespace {

/// Collects the values of a section as names and texts.
class ValueLister {
public:
    explicit ValueLister(std::vector<ProjectValue>& to) : to_{to} {}

    void begin(std::string section) { section_ = std::move(section); }
    void text(std::string_view name, const std::string& value) { add(name, value); }
    void flag(std::string_view name, bool value) { add(name, value ? "yes" : "no"); }
    void number(std::string_view name, std::uint32_t value) { add(name, std::to_string(value)); }
    void list(std::string_view name, const std::vector<std::string>& value)
    {
        add(name, detail::value_text(value));
    }
    template <typename T, std::size_t count>
    void choice(std::string_view name, const T& value, const detail::Choices<T, count>& choices)
    {
        add(name, std::string{detail::value_text(value, choices)});
    }

private:
    void add(std::string_view name, std::string value)
    {
        to_.push_back({section_.empty() ? std::string{name} : section_ + "." + std::string{name},
                       std::move(value)});
    }

    std::vector<ProjectValue>& to_;
    std::string section_;
};

/// Turns "listener 2.address" into "[listener 2] address".
std::string place_of(const std::string& name)
{
    const std::size_t point = name.find('.');
    return point == std::string::npos ? name
                                      : "[" + name.substr(0, point) + "] " + name.substr(point + 1);
}

Configured<void> check_text(const ProjectValue& value, std::size_t max_text)
{
    if (value.value.size() > max_text) {
        return misconfigured(place_of(value.name), "found " + std::to_string(value.value.size()) +
                                                       " bytes, expected at most " +
                                                       std::to_string(max_text));
    }
    if (!detail::is_project_text(value.value)) {
        return misconfigured(
            place_of(value.name),
            "found control characters or bytes that are not UTF-8, expected text of one line");
    }
    return {};
}

Configured<void> check_count(std::string_view what, std::size_t found, std::size_t most)
{
    return found <= most
               ? Configured<void>{}
               : misconfigured(std::string{what}, "found " + std::to_string(found) +
                                                      ", expected at most " + std::to_string(most));
}

Configured<void> check_written(const Project& project, const std::vector<ProjectValue>& values,
                               const ProjectLimits& limits)
{
    for (const ProjectValue& value : values) {
        if (auto checked = check_text(value, limits.max_text); !checked) {
            return checked;
        }
    }
    for (std::size_t i = 0; i < project.models.size(); ++i) {
        const std::string place = "model " + std::to_string(i + 1);
        if (auto checked = check_text({place + ".name", project.models[i].name}, limits.max_text);
            !checked) {
            return checked;
        }
        if (auto checked = check_count("[" + place + "] size", project.models[i].text.size(),
                                       limits.max_model_size);
            !checked) {
            return checked;
        }
    }
    std::vector<std::string> policies;
    if (!detail::read_value(detail::value_text(project.security.policies), policies).empty() ||
        policies != project.security.policies) {
        return misconfigured("[security] policies", "found a name with a comma or an empty one");
    }
    return check_count("listeners", project.network.listeners.size(), limits.max_listeners)
        .and_then([&] { return check_count("users", project.users.size(), limits.max_users); })
        .and_then([&] { return check_count("models", project.models.size(), limits.max_models); });
}

void append_value(std::string& to, std::string_view name, std::string_view value)
{
    to += name;
    to += value.empty() ? " =" : " = ";
    to += value;
    to += '\n';
}

/// Turns "listener 2" into "[listener]".
std::string section_title(std::string_view section)
{
    return "[" + std::string{section.substr(0, section.find(' '))} + "]";
}

void append_values(std::string& to, const std::vector<ProjectValue>& values)
{
    std::string section;
    for (const ProjectValue& value : values) {
        const std::size_t point = value.name.find('.');
        if (point == std::string::npos) {
            append_value(to, value.name, value.value);
            continue;
        }
        if (const std::string now = value.name.substr(0, point); now != section) {
            section = now;
            to += '\n' + section_title(section) + '\n';
        }
        append_value(to, std::string_view{value.name}.substr(point + 1), value.value);
    }
}

void append_model(std::string& to, const ProjectModel& model)
{
    to += "\n[model]\n";
    append_value(to, "name", model.name);
    append_value(to, "size", std::to_string(model.text.size()));
    append_value(to, "checksum", detail::checksum_text(model.text));
    to += model.text;
    to += '\n';
}

} // namespace

std::vector<ProjectValue> values_of(const Project& project)
{
    std::vector<ProjectValue> values;
    ValueLister lister{values};
    detail::visit_project(lister, project);
    detail::for_each_section([&](std::string_view section, auto visit) {
        lister.begin(std::string{section});
        visit(lister, project);
    });
    for (std::size_t i = 0; i < project.network.listeners.size(); ++i) {
        lister.begin("listener " + std::to_string(i + 1));
        detail::visit_listener(lister, project.network.listeners[i]);
    }
    for (std::size_t i = 0; i < project.users.size(); ++i) {
        lister.begin("user " + std::to_string(i + 1));
        detail::visit_user(lister, project.users[i]);
    }
    return values;
}

Configured<std::string> document_of(const Project& project, const ProjectLimits& limits)
{
    const std::vector<ProjectValue> values = values_of(project);
    if (auto checked = check_written(project, values, limits); !checked) {
        return Unexpected{std::move(checked.error())};
    }
    std::string document = "busbar project " + std::to_string(project_version) + "\n";
    append_values(document, values);
    for (const ProjectModel& model : project.models) {
        append_model(document, model);
    }
    document += "\n[end]\n";
    append_value(document, "checksum", detail::checksum_text(document));
    if (auto checked = check_count("size", document.size(), limits.max_file_size); !checked) {
        return Unexpected{std::move(checked.error())};
    }
    return document;
}

} // namespace busbar::controller
