#include "completion.hpp"

#include <algorithm>
#include <sstream>

#include <CLI/CLI.hpp>

namespace busbar::command_line {

namespace {

constexpr std::string_view values_begin = "values:";

/// Words of a shell, the last of which may be empty.
class Words {
public:
    explicit Words(const std::string& line)
    {
        for (const char character : line) {
            take(character);
        }
        words.push_back(word_);
        is_quoted = begins_quoted_;
    }

    std::vector<std::string> words;
    bool is_quoted{false};

private:
    void take(char character)
    {
        if (is_escaped_) {
            word_ += character;
            is_escaped_ = false;
        } else if (quote_ != '\0') {
            in_quotes(character);
        } else if (character == '\\') {
            is_escaped_ = true;
        } else if (character == '"' || character == '\'') {
            begins_quoted_ = begins_quoted_ || word_.empty();
            quote_ = character;
        } else if (character == ' ' || character == '\t') {
            end();
        } else {
            word_ += character;
        }
    }
    void in_quotes(char character)
    {
        if (character == quote_) {
            quote_ = '\0';
        } else if (character == '\\' && quote_ == '"') {
            is_escaped_ = true;
        } else {
            word_ += character;
        }
    }
    void end()
    {
        if (!word_.empty() || begins_quoted_) {
            words.push_back(word_);
        }
        word_.clear();
        begins_quoted_ = false;
    }

    std::string word_;
    char quote_{'\0'};
    bool is_escaped_{false};
    bool begins_quoted_{false};
};

const CLI::Option* find_option(const CLI::App& command, const std::string& name)
{
    for (const CLI::App* level = &command; level != nullptr; level = level->get_parent()) {
        if (const CLI::Option* const found = level->get_option_no_throw(name)) {
            return found;
        }
    }
    return nullptr;
}

bool takes_value(const CLI::Option* option)
{
    return option != nullptr && option->get_type_size() != 0 && !option->get_positional();
}

const CLI::App* find_command(const CLI::App& level, const std::string& name)
{
    const auto found =
        level.get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
    return found.empty() || name.empty() ? nullptr : found.front();
}

std::vector<std::string> split(const std::string& text, char separator)
{
    std::vector<std::string> parts;
    std::istringstream stream{text};
    for (std::string part; std::getline(stream, part, separator);) {
        parts.push_back(part);
    }
    return parts;
}

/// Reads the values from a set that CLI11 prints, "{Sign,SignAndEncrypt}", or from values_name().
std::vector<std::string> values_of(const CLI::Option& option)
{
    const std::string& type = option.get_type_name();
    const std::size_t open = type.find('{');
    const std::size_t close = type.find('}', open == std::string::npos ? 0 : open);
    if (open != std::string::npos && close != std::string::npos) {
        return split(type.substr(open + 1, close - open - 1), ',');
    }
    // Only an option that may be changed hands its checks out.
    auto& checked =
        const_cast<CLI::Option&>(option); // NOLINT(cppcoreguidelines-pro-type-const-cast)
    try {
        for (int i = 0;; ++i) {
            const std::string& name = checked.get_validator(i)->get_name();
            if (name.starts_with(values_begin)) {
                return split(name.substr(values_begin.size()), ' ');
            }
        }
    } catch (const CLI::OptionNotFound&) {
        return {};
    }
}

std::vector<std::string> names_of_options(const CLI::App& command)
{
    std::vector<std::string> names;
    for (const CLI::App* level = &command; level != nullptr; level = level->get_parent()) {
        for (const CLI::Option* option : level->get_options(
                 [](const CLI::Option* each) { return !each->get_group().empty(); })) {
            for (const std::string& name : option->get_lnames()) {
                if (std::find(names.begin(), names.end(), "--" + name) == names.end()) {
                    names.push_back("--" + name);
                }
            }
        }
    }
    return names;
}

std::vector<std::string> names_of_commands(const CLI::App& level)
{
    std::vector<std::string> names;
    for (const CLI::App* command :
         level.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); })) {
        names.push_back(command->get_name());
    }
    return names;
}

/// Returns the part of the word that stays: an option before its =, and elements before the last.
std::string kept_part(const CompletionPlace& place)
{
    std::string kept;
    if (place.option != nullptr && place.word.starts_with("--")) {
        kept = place.word.substr(0, place.word.find('=') + 1);
    }
    const char delimiter = place.option == nullptr ? '\0' : place.option->get_delimiter();
    const std::size_t last = delimiter == '\0' ? std::string::npos : place.word.rfind(delimiter);
    return last == std::string::npos ? kept : place.word.substr(0, last + 1);
}

std::vector<std::string> all_candidates(const CompletionPlace& place, const Completer& completer)
{
    if (place.option != nullptr) {
        auto values = values_of(*place.option);
        return values.empty() && completer ? completer(place) : values;
    }
    if (place.word.starts_with('-')) {
        return names_of_options(*place.command);
    }
    auto commands = names_of_commands(*place.command);
    return commands.empty() && completer ? completer(place) : commands;
}

/// Returns the size of the part of the word that bash does not replace.
std::size_t size_before(const CompletionPlace& place, const std::string& breaks)
{
    const std::size_t last =
        place.is_quoted || breaks.empty() ? std::string::npos : place.word.find_last_of(breaks);
    return last == std::string::npos ? 0 : last + 1;
}

} // namespace

std::string values_name(const std::vector<std::string>& values)
{
    std::string name{values_begin};
    for (const std::string& value : values) {
        name += (name.size() == values_begin.size() ? "" : " ") + value;
    }
    return name;
}

CompletionPlace completion_place(const CLI::App& app, const std::string& line)
{
    const Words words{line};
    CompletionPlace place{&app};
    place.word = words.words.back();
    place.is_quoted = words.is_quoted;
    place.words.assign(words.words.begin() + (words.words.size() > 1 ? 1 : 0),
                       words.words.end() - 1);
    const CLI::Option* option = nullptr;
    for (const std::string& word : place.words) {
        if (option != nullptr) {
            option = nullptr; // its value
        } else if (word.starts_with('-') && word.size() > 1) {
            const bool has_value = word.find('=') != std::string::npos;
            const CLI::Option* const found = find_option(*place.command, word);
            option = takes_value(found) && !has_value ? found : nullptr;
        } else if (const CLI::App* const command = find_command(*place.command, word)) {
            place.command = command;
        } else {
            place.arguments.push_back(word);
        }
    }
    const std::size_t end = place.word.find('=');
    if (option == nullptr && place.word.starts_with("--") && end != std::string::npos) {
        const CLI::Option* const found = find_option(*place.command, place.word.substr(0, end));
        option = takes_value(found) ? found : nullptr;
    }
    place.option = option;
    return place;
}

std::vector<std::string> completions(const CLI::App& app, const std::string& line,
                                     const Completer& completer)
{
    return completions(app, line, completer, "");
}

std::vector<std::string> completions(const CLI::App& app, const std::string& line,
                                     const Completer& completer, const std::string& breaks)
{
    const CompletionPlace place = completion_place(app, line);
    const std::string kept = kept_part(place);
    CompletionPlace part = place;
    part.word.erase(0, kept.size());
    const std::size_t before = size_before(place, breaks);
    std::vector<std::string> found;
    for (const std::string& candidate : all_candidates(part, completer)) {
        const std::string whole = kept + candidate;
        if (whole.starts_with(place.word) && whole.size() >= before) {
            found.push_back(whole.substr(before));
        }
    }
    return found;
}

std::string completion_script(const std::string& program, const std::string& shell)
{
    if (shell == "fish") {
        return "complete -c " + program + " -f -a '(" + program +
               " --complete (commandline -cp | string collect) 2>/dev/null </dev/null)'\n";
    }
    std::string function = "_" + program;
    std::replace(function.begin(), function.end(), '-', '_');
    const std::string call = "\"${COMP_WORDS[0]}\" --complete \"${COMP_LINE:0:$COMP_POINT}\" "
                             "--complete-breaks \"$COMP_WORDBREAKS\" 2>/dev/null </dev/null";
    std::string body = function +
                       "() {\n"
                       "  local IFS=$'\\n'\n"
                       "  COMPREPLY=()\n"
                       "  local candidate\n"
                       "  while IFS= read -r candidate; do\n"
                       "    COMPREPLY+=(\"$candidate\")\n"
                       "  done < <(" +
                       call +
                       ")\n"
                       "  case \"${COMPREPLY[*]}\" in */* | *' '*) compopt -o filenames "
                       "2>/dev/null ;; esac\n"
                       "  case \"${COMPREPLY[*]}\" in */ | *=) compopt -o nospace "
                       "2>/dev/null ;; esac\n"
                       "}\n"
                       "complete -o default -F " +
                       function + " " + program + "\n";
    if (shell != "zsh") {
        return body;
    }
    // As a file of $fpath, the script is the body of the function, which has to complete at once.
    return "#compdef " + program + "\nautoload -U +X bashcompinit && bashcompinit\n" + body +
           "if [ \"${funcstack[1]}\" = " + function + " ]; then\n  _bash_complete -o default -F " +
           function + "\nfi\n";
}

} // namespace busbar::command_line
