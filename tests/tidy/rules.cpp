#include "rules.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <regex>
#include <span>

namespace busbar::tidy {

namespace {

struct Layer {
    std::string_view name;
    std::string_view may_include; // with blanks around each
};

constexpr std::array layers = {
    Layer{"core", " core "},
    Layer{"binary", " core binary types "},
    Layer{"storage", " core storage "},
    Layer{"crypto", " core crypto "},
    Layer{"channel", " core binary types crypto channel "},
    Layer{"model", " core binary types model nodes "},
    Layer{"server", " core binary types crypto channel model nodes server "},
    Layer{"administration", " core binary types crypto channel model nodes server administration "},
    Layer{"client", " core binary types crypto channel client "},
    Layer{"backend", " core binary types crypto channel model nodes server backend "},
    Layer{"net",
          " core binary types crypto channel model nodes server client backend storage net "},
    Layer{"c", " core binary types crypto channel model nodes server client storage net c "},
    Layer{"harness",
          " core binary types crypto channel model nodes server client backend harness "},
    Layer{"harness_net", " core binary types crypto channel model nodes server client backend "
                         "storage net harness harness_net "},
    Layer{"controller", " core binary types crypto channel model nodes server backend controller "},
    Layer{"command_line", " core command_line "},
    Layer{"product",
          " core command_line binary types crypto channel model nodes server administration client "
          "backend storage net controller product "},
    Layer{"tool",
          " core command_line binary types crypto channel model nodes server administration client "
          "backend storage net harness harness_net controller tool "},
};
/// These have threads, clocks and exceptions.
constexpr std::array<std::string_view, 7> outer_layers = {
    "net", "c", "harness_net", "controller", "command_line", "product", "tool"};

/// The floors of lib/server, each with those that it stands on; siblings know nothing of each
/// other.
constexpr std::array floors = {
    Layer{"data", " data "},
    Layer{"image", " data image "},
    Layer{"rights", " data image rights "},
    Layer{"users", " data image rights users "},
    Layer{"session", " data image rights users session "},
    Layer{"attribute", " data image rights users session attribute "},
    Layer{"view", " data image rights users session view "},
    Layer{"method", " data image rights users session method "},
    Layer{"node_management", " data image rights users session node_management "},
    Layer{"subscription", " data image rights users session subscription "},
    Layer{"event", " data image rights users session event "},
    Layer{"diagnostics", " data image rights users session attribute view method node_management "
                         "subscription event diagnostics "},
    Layer{"engine", " data image rights users session attribute view method node_management "
                    "subscription event diagnostics engine "},
};
/// Public headers that only the top floor may include: all that is below works without a Server.
constexpr std::array<std::string_view, 3> engine_headers = {"config_check.hpp", "connection.hpp",
                                                            "server.hpp"};

constexpr std::size_t max_file_lines = 700;
constexpr std::size_t max_function_lines = 70;
constexpr std::size_t max_columns = 100;

bool starts_with(std::string_view text, std::string_view prefix)
{
    return text.substr(0, prefix.size()) == prefix;
}

/// The layer that `path` belongs to: lib/<layer>/... or include/busbar/<layer>/...
const Layer* layer_of(std::string_view path)
{
    for (const std::string_view root : {"lib/", "include/busbar/"}) {
        if (!starts_with(path, root)) {
            continue;
        }
        const std::string_view rest = path.substr(root.size());
        const std::string_view name = rest.substr(0, rest.find('/'));
        const auto found = std::find_if(layers.begin(), layers.end(),
                                        [&](const Layer& layer) { return layer.name == name; });
        return found == layers.end() ? nullptr : &*found;
    }
    return nullptr;
}

/// The floor that `path` belongs to: lib/server/<floor>/...; null if it is elsewhere.
const Layer* floor_of(std::string_view path)
{
    constexpr std::string_view root = "lib/server/";
    if (!starts_with(path, root)) {
        return nullptr;
    }
    const std::string_view rest = path.substr(root.size());
    const std::string_view name = rest.substr(0, rest.find('/'));
    const auto found = std::find_if(floors.begin(), floors.end(),
                                    [&](const Layer& floor) { return floor.name == name; });
    return found == floors.end() ? nullptr : &*found;
}

bool is_source(std::string_view path)
{
    return path.ends_with(".cpp") || path.ends_with(".hpp");
}

void report(const File& file, std::size_t line, std::string_view what, Findings& findings)
{
    findings.push_back(file.path + ":" + std::to_string(line + 1) + ": " + std::string{what});
}

/// Columns as a reader counts them: UTF-8 continuation bytes take none.
std::size_t columns(std::string_view line)
{
    return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
        return (static_cast<unsigned>(c) & 0xC0U) != 0x80U;
    }));
}

/// The house format puts a function's braces alone on a line, and only a function's.
std::optional<std::size_t> function_end(const File& file, std::size_t line)
{
    const std::string& open = file.lines[line];
    const std::size_t indent = open.find_first_not_of(' ');
    if (indent == std::string::npos || open.substr(indent) != "{") {
        return std::nullopt;
    }
    const std::string close = open.substr(0, indent) + "}";
    for (std::size_t end = line + 1; end < file.lines.size(); ++end) {
        if (starts_with(file.lines[end], close)) {
            return end;
        }
    }
    return std::nullopt;
}

bool is_public(std::string_view path)
{
    return starts_with(path, "include/");
}

/// Texts one of which is in every line that a pattern matches. A search for them is many times as
/// fast as std::regex.
using Signs = std::array<std::string_view, 3>;

bool has_sign(std::string_view line, std::span<const std::string_view> signs)
{
    return std::any_of(signs.begin(), signs.end(), [&](std::string_view sign) {
        return !sign.empty() && line.find(sign) != std::string_view::npos;
    });
}

struct Ban {
    Signs signs;
    const char* pattern;
    const char* reason;
    bool (*applies)(std::string_view path);
};

bool in_library(std::string_view path)
{
    return layer_of(path) != nullptr;
}

bool below_net(std::string_view path)
{
    const Layer* layer = layer_of(path);
    return layer != nullptr &&
           std::find(outer_layers.begin(), outer_layers.end(), layer->name) == outer_layers.end();
}

bool on_wire_data(std::string_view path)
{
    const Layer* layer = layer_of(path);
    const bool is_codec = path == "include/busbar/binary/wire_order.hpp" ||
                          path == "include/busbar/binary/writer.hpp" ||
                          path == "lib/binary/writer.cpp";
    return layer != nullptr && !is_codec &&
           (layer->name == "binary" || layer->name == "channel" || layer->name == "client");
}

const std::array bans = {
    Ban{{"rand"}, R"(\bs?rand\s*\()", "rand: use the injected Random", in_library},
    Ban{{"assert"}, R"(\bassert\s*\()", "assert: input is checked with a status", in_library},
    Ban{{"abort"}, R"(\babort\s*\()", "abort: the library never ends the process", in_library},
    Ban{{"_clock::now"},
        R"((system|steady)_clock::now)",
        "a clock below net: time is passed in",
        below_net},
    Ban{{"sleep"}, R"(sleep_(for|until)|\busleep\b)", "sleeping below net", below_net},
    Ban{{"thread"}, R"(std::(jthread|thread)\b)", "a thread below net", below_net},
    Ban{{"memcpy"},
        R"(\bmemcpy\s*\()",
        "memcpy on wire data outside Reader and Writer",
        on_wire_data},
    Ban{{"<iostream>"}, R"(#include <iostream>)", "iostream in the library", below_net},
    Ban{{"NodeId{0", ".is(", "uint32_t id_"},
        R"(NodeId\{0, *[0-9]|\.is\([0-9]|uint32_t id_[a-z_]+ = [0-9])",
        "a number for a node of namespace 0: busbar/types/ids.hpp has its name",
        in_library},
    Ban{{"dynamic_cast", "typeid"},
        R"(\b(dynamic_cast|typeid)\b)",
        "RTTI in a layer that is built without",
        below_net},
    Ban{{"BUSBAR_"},
        R"(^\s*#\s*(el)?if.*\bBUSBAR_)",
        "a public type that is another one with other options",
        is_public},
};

} // namespace

File make_file(std::string path, std::string_view text)
{
    File file{std::move(path), {}};
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        file.lines.emplace_back(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return file;
}

void check_includes(const File& file, Findings& findings)
{
    const Layer* layer = layer_of(file.path);
    if (layer == nullptr) {
        return;
    }
    static const std::regex include{R"re(^#include [<"](?:busbar/)?([a-z0-9_]+)/)re"};
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        std::smatch match;
        if (!starts_with(file.lines[i], "#include ") ||
            !std::regex_search(file.lines[i], match, include)) {
            continue;
        }
        const std::string name = match[1];
        const bool is_layer = std::any_of(layers.begin(), layers.end(),
                                          [&](const Layer& l) { return l.name == name; });
        if (is_layer && layer->may_include.find(" " + name + " ") == std::string_view::npos) {
            report(file, i, std::string{layer->name} + " must not include " + name, findings);
        }
    }
}

void check_floors(const File& file, Findings& findings)
{
    const Layer* const floor = floor_of(file.path);
    if (floor == nullptr) {
        if (starts_with(file.path, "lib/server/") && is_source(file.path)) {
            report(file, 0, "a file of the server is on one of its floors", findings);
        }
        return;
    }
    static const std::regex inside{R"re(#include "server/(\w+)/)re"};
    static const std::regex outside{R"re(#include <busbar/server/([\w.]+)>)re"};
    static const std::regex core{R"(\bstruct Core\b)"};
    constexpr Signs signs{"#include ", "struct Core"};
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        std::smatch match;
        if (!has_sign(file.lines[i], signs)) {
            continue;
        }
        if (std::regex_search(file.lines[i], match, inside)) {
            const std::string name = match[1];
            if (floor->may_include.find(" " + name + " ") == std::string_view::npos) {
                report(file, i, std::string{floor->name} + " must not include " + name, findings);
            }
        } else if (std::regex_search(file.lines[i], match, outside)) {
            const bool is_engine = std::find(engine_headers.begin(), engine_headers.end(),
                                             match[1].str()) != engine_headers.end();
            if (is_engine && floor->name != "engine") {
                report(file, i, std::string{floor->name} + " must not know of the server",
                       findings);
            }
        } else if (std::regex_search(file.lines[i], core) && floor->name != "engine") {
            report(file, i, "Core is for the engine only", findings);
        }
    }
}

void check_lengths(const File& file, Findings& findings)
{
    if (file.lines.size() > max_file_lines) {
        report(file, file.lines.size() - 1, "the file is longer than 700 lines", findings);
    }
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        if (columns(file.lines[i]) > max_columns) {
            report(file, i, "the line is longer than 100 columns", findings);
        }
        const auto end = function_end(file, i);
        if (end && *end - i - 1 > max_function_lines) {
            report(file, i, "the function is longer than 70 lines", findings);
        }
    }
}

void check_calls(const File& file, Findings& findings)
{
    static const std::vector<std::regex> patterns = [] {
        std::vector<std::regex> all;
        for (const Ban& ban : bans) {
            all.emplace_back(ban.pattern);
        }
        return all;
    }();
    for (std::size_t number = 0; number < bans.size(); ++number) {
        const Ban& ban = bans[number];
        if (!ban.applies(file.path)) {
            continue;
        }
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            if (!has_sign(file.lines[i], ban.signs)) {
                continue;
            }
            const std::string code = file.lines[i].substr(0, file.lines[i].find("//"));
            if (std::regex_search(code, patterns[number])) {
                report(file, i, ban.reason, findings);
            }
        }
    }
}

/// A framework that reports a failure knows the worlds of its test only as those of the process,
/// whose is operator new, too.
constexpr std::array<std::string_view, 6> know_the_process = {
    "include/busbar/harness/catch.hpp",
    "include/busbar/harness/doctest.hpp",
    "include/busbar/harness/failing_memory_main.hpp",
    "include/busbar/harness/gtest.hpp",
    "lib/c/allocator.cpp",
    "lib/harness/world.cpp"};

void check_state(const File& file, Findings& findings)
{
    const Layer* const layer = layer_of(file.path);
    if (layer == nullptr || std::find(know_the_process.begin(), know_the_process.end(),
                                      file.path) != know_the_process.end()) {
        return;
    }
    // A handler of a signal knows nothing but variables of the program.
    const bool has_handlers = layer->name == "tool";
    static const std::regex kept{
        R"(^ +(inline )?static (?!(inline )?const(expr)?\b)(?!.*operator)[\w:<>,&* ]+ \w+ *[;={])"};
    static const std::regex global{
        R"(^(?!(inline |static |constinit )*(const|constexpr|extern|using|typedef|template|struct|)"
        R"(class|enum|union|namespace|friend|return|requires|concept|operator|static_assert)\b))"
        R"((?!.*operator)[A-Za-z_][\w:<>,&* ]*[ *&][\w:]+(;|\{.*|\[.*| = .*)$)"};
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string code = file.lines[i].substr(0, file.lines[i].find("//"));
        if (has_sign(code, Signs{"thread_local"})) {
            report(file, i, "state of a thread: pass it to whoever needs it", findings);
        } else if (code.find(" static ") != std::string::npos && std::regex_search(code, kept)) {
            report(file, i, "state of the process: make it a member", findings);
        } else if (!has_handlers && code.find_first_of(";={") != std::string::npos &&
                   code.front() != ' ' && std::regex_search(code, global)) {
            report(file, i, "a variable of the process: make it a member", findings);
        }
    }
}

void check_traces(const File& file, Findings& findings)
{
    static const std::regex machine_path{R"((^|[^\w])/(home|root|Users|work|mnt|tmp)/\w)"};
    constexpr std::array<std::string_view, 6> signs{"/home/", "/root/", "/Users/",
                                                    "/work/", "/mnt/",  "/tmp/"};
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        if (has_sign(file.lines[i], signs) && std::regex_search(file.lines[i], machine_path)) {
            report(file, i, "a path of a machine", findings);
        }
    }
    const bool is_header = file.path.size() > 4 && file.path.substr(file.path.size() - 4) == ".hpp";
    if (is_header && (file.lines.empty() || file.lines[0] != "#pragma once")) {
        report(file, 0, "a header begins with #pragma once", findings);
    }
}

void check_virtuals(const File& file, Findings& findings)
{
    if (!starts_with(file.path, "include/")) {
        return;
    }
    static const std::regex begin{R"(^ +(\[\[nodiscard\]\] )?virtual )"};
    static const std::regex elsewhere{R"([^;{]*;)"};
    static const std::regex pure_or_default{R"([^;{]*= (0|default);)"};
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        if (!has_sign(file.lines[i], Signs{"virtual "}) ||
            !std::regex_search(file.lines[i], begin)) {
            continue;
        }
        std::string declaration;
        for (std::size_t j = i; j < file.lines.size(); ++j) {
            declaration += file.lines[j];
            if (declaration.find_first_of(";{") != std::string::npos) {
                break;
            }
        }
        constexpr auto from_start = std::regex_constants::match_continuous;
        if (std::regex_search(declaration, elsewhere, from_start) &&
            !std::regex_search(declaration, pure_or_default, from_start)) {
            report(file, i, "a virtual function is pure or defined in its class", findings);
        }
    }
}

std::vector<std::string> defined_types(const File& file)
{
    static const std::regex definition{
        R"(^(?:class|struct|enum class) (?:BUSBAR_API )?(\w+)(?: final)?(?: : [^;]*)?(?: \{.*)?$)"};
    std::vector<std::string> names;
    for (const std::string& line : file.lines) {
        std::smatch match;
        const bool may_define = starts_with(line, "class ") || starts_with(line, "struct ") ||
                                starts_with(line, "enum class ");
        if (may_define && std::regex_match(line, match, definition)) {
            names.push_back(match[1]);
        }
    }
    return names;
}

Findings find_twins(const std::vector<File>& headers)
{
    // Both ends of a connection, in a namespace each; and what a NodeSet file says of a text or a
    // reference before it is one.
    constexpr std::string_view may_have_twins =
        " Connection ConnectionEvent LocalizedText Reference ";
    std::map<std::string, std::string> homes;
    Findings findings;
    for (const File& file : headers) {
        for (const std::string& name : defined_types(file)) {
            const auto [home, is_new] = homes.emplace(name, file.path);
            if (!is_new && may_have_twins.find(" " + name + " ") == std::string_view::npos) {
                findings.push_back(file.path + ": " + name + " is also in " + home->second);
            }
        }
    }
    return findings;
}

Findings check(const File& file)
{
    Findings findings;
    check_includes(file, findings);
    check_floors(file, findings);
    check_lengths(file, findings);
    check_calls(file, findings);
    check_state(file, findings);
    check_traces(file, findings);
    check_virtuals(file, findings);
    return findings;
}

} // namespace busbar::tidy
