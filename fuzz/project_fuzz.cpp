#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/controller/project.hpp>
#include <busbar/controller/project_compare.hpp>
#include <controller/life/checksum.hpp>

namespace project_fuzz {

using namespace busbar::controller;

namespace {

void expect(bool holds)
{
    if (!holds) {
        __builtin_trap();
    }
}

constexpr ProjectLimits fuzzed_limits{.max_file_size = 1U << 16U,
                                      .max_model_size = 1U << 14U,
                                      .max_models = 8,
                                      .max_users = 8,
                                      .max_listeners = 4,
                                      .max_text = 200};

/// With an end that is right, so that what is behind the checksum is reached.
std::string sealed(std::string_view text)
{
    std::string file = std::string{text} + "[end]\n";
    return file + "checksum = " + detail::checksum_text(file) + "\n";
}

void use(const Project& project)
{
    static_cast<void>(check(project));
    static_cast<void>(endpoint_urls(project.network));
    static_cast<void>(allowed_security(project.security));
    expect(setting_differences(project, project).empty());
    for (const ProjectValue& value : values_of(project)) {
        Project again = project;
        expect(set_project_value(again, value.name, value.value).has_value());
        expect(again == project);
    }
}

} // namespace

/// A project file of any origin, with and without its end: what is read is written and read as the
/// same project, and every problem names the file.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    for (const std::string& file : {std::string{text}, sealed(text)}) {
        const auto project = read_project(file, "fuzzed", fuzzed_limits);
        if (!project) {
            expect(project.error().where.starts_with("fuzzed") && project.error().status.is_bad());
            continue;
        }
        const auto written = document_of(*project, fuzzed_limits);
        if (!written) {
            // It may become longer than it was read: blanks that were left out.
            continue;
        }
        const auto again = read_project(*written, "written", fuzzed_limits);
        expect(again.has_value() && *again == *project);
        expect(document_of(*again, fuzzed_limits).value() == *written);
        use(*project);
    }
    return 0;
}

} // namespace project_fuzz
