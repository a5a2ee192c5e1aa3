#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include <busbar/channel/endpoint_url.hpp>

#include "require.hpp"
#include "tool/commands/commands.hpp"
#include "tool/connection/failure.hpp"

namespace command_line_fuzz {

using namespace busbar;
using fuzz::require;

namespace {

/// What stands between zeros.
std::vector<std::string> words_in(std::string_view text)
{
    std::vector<std::string> words{"busbar"};
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\0', begin), text.size());
        words.emplace_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

/// That a URL is completed once and for all, or refused as a mistake of the command line.
void check_url(const std::string& word)
{
    try {
        const std::string url = tool::complete_url(word);
        require(channel::EndpointUrl::parse(url).has_value() && tool::complete_url(url) == url);
    } catch (const tool::Failure& failure) {
        require(failure.exit == tool::Exit::Usage && !failure.hint.empty());
    }
}

/// That nothing but the first "--" is lost on the way to CLI11, and the marks come off again.
void check_protection(const std::vector<std::string>& words, std::vector<std::string> passed)
{
    std::vector<std::string> expected{words.begin() + 1, words.end()};
    const auto separator = std::ranges::find(expected, "--");
    if (separator != expected.end()) {
        expected.erase(separator);
    }
    std::ranges::for_each(passed, tool::unmark);
    std::ranges::reverse(passed);
    const bool has_mark = std::ranges::any_of(
        expected, [](const std::string& word) { return word.starts_with('\x1f'); });
    require(has_mark || passed == expected);
}

/// Help, or a mistake that is told as one.
void check_end(const CLI::App& app, const CLI::ParseError& error)
{
    std::ostringstream help;
    std::ostringstream ignored;
    if (app.exit(error, help, ignored) == 0) {
        require(!help.str().empty());
        return;
    }
    const tool::Failure failure = tool::usage_failure(app, error);
    require(failure.exit == tool::Exit::Usage && *failure.what() != '\0');
    require(tool::json_of(failure).starts_with('{'));
}

} // namespace

/// Any words as the command line of busbar, as far as they only say what is to be done.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    auto words = words_in({reinterpret_cast<const char*>(data), size});
    std::vector<char*> arguments;
    for (std::string& word : words) {
        check_url(word);
        arguments.push_back(word.data());
    }
    const auto passed = tool::protected_arguments(static_cast<int>(words.size()), arguments.data());
    check_protection(words, passed);
    tool::Options options;
    tool::Run run;
    CLI::App app{"Looks into OPC UA servers and works with them.", "busbar"};
    tool::add_command_line(app, options, run);
    try {
        app.parse(std::vector<std::string>(passed));
        require(run != nullptr);
    } catch (const CLI::ParseError& error) {
        check_end(app, error);
    } catch (const tool::Failure& failure) {
        require(failure.exit == tool::Exit::Usage);
    }
    return 0;
}

} // namespace command_line_fuzz
