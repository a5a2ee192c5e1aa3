#include <catch2/catch.hpp>

#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/core/version.hpp>

#include "command_line/manual_page.hpp"
#include "command_line/program_options.hpp"

namespace manual_page_test {

using namespace busbar;

namespace {

/// A program with a command of a command, an option of each kind and a footer.
struct Program {
    Program()
    {
        app.add_option("FILE", text, "what is read")->required();
        app.add_option("-p,--port", number, "where it listens")->capture_default_str();
        CLI::App* const cert = app.add_subcommand("cert", "Certificates.");
        CLI::App* const list = cert->add_subcommand("list", "Lists them.");
        list->add_flag("--all", "the rejected, too");
        list->footer("Those in use come first.");
        app.footer("Exit codes: 0 good.");
        command_line::add_program_options(app, "tester");
    }

    /// What the program prints for one word; nothing if it would go on.
    std::optional<std::string> answer(const char* word)
    {
        const char* words[] = {"tester", word};
        try {
            app.parse(2, words);
        } catch (const CLI::ParseError& error) {
            std::ostringstream out;
            std::ostringstream ignored;
            return app.exit(error, out, ignored) == 0 ? std::optional{out.str()} : std::nullopt;
        }
        return std::nullopt;
    }

    std::string text;
    int number{4840};
    CLI::App app{"Tests what is tested. And more."};
};

bool has(const std::optional<std::string>& text, const std::string& part)
{
    return text && text->find(part) != std::string::npos;
}

} // namespace

TEST_CASE("a manual page keeps what the formatter would take for its own", "[command_line]")
{
    command_line::ManualPage page{"tester", "Tests", "[OPTIONS]", {}};
    page.sections.push_back({"NOTES",
                             ".TH at the start, a \\ in between, --all\n\nNext.\n  kept\n",
                             {{"\"quoted\"", "'first"}},
                             false});
    const std::string text = text_of(page, "1.2.3");
    CHECK(has(text, ".TH \"tester\" 1 \"\" \"Busbar 1.2.3\""));
    CHECK(has(text, "tester \\- Tests\n"));
    CHECK(has(text, "\n\\&.TH at the start, a \\e in between, \\-\\-all\n.PP\nNext.\n"));
    CHECK(has(text, ".nf\n  kept\n.fi\n"));
    CHECK(has(text, ".B \"\\(dqquoted\\(dq\"\n\\&'first\n"));
}

TEST_CASE("a program answers with its version, its page and its completion", "[command_line]")
{
    Program program;
    CHECK(program.answer("--version") == "tester " + std::string{version()} + "\n");
    const auto page = program.answer("--print-man");
    CHECK(has(page, "tester \\- Tests what is tested\n"));
    CHECK(has(page, "\n[OPTIONS] FILE [COMMAND]\n"));
    CHECK(has(page, ".B \"\\-p, \\-\\-port INT\"\nwhere it listens; default: 4840\n"));
    CHECK(has(page, ".SS \"cert list [OPTIONS]\"\nLists them.\n.PP\nThose in use come first.\n"));
    CHECK(has(page, ".B \"\\-\\-all\"\nthe rejected, too\n"));
    // Of the program, not of each command.
    REQUIRE(page);
    CHECK(page->find("Exit codes") == page->rfind("Exit codes"));
    CHECK_FALSE(has(page, "print\\-man"));
    const auto completion = program.answer("--print-completion");
    CHECK(has(completion, "--complete \"${COMP_LINE:0:$COMP_POINT}\""));
    CHECK(has(completion, "complete -o default -F _tester tester\n"));
    CHECK_FALSE(has(program.answer("--help"), "--print"));
}

TEST_CASE("a line is completed by what the program understands", "[command_line]")
{
    using Words = std::vector<std::string>;
    Program program;
    program.app.add_option("--level", program.text, "how much")
        ->check(CLI::IsMember({"low", "high"}));
    program.app.add_option("--steps", program.text, "which")
        ->check([](const std::string&) { return std::string{}; }, "",
                command_line::values_name({"first", "second"}));
    const auto of = [&program](const std::string& line) {
        return command_line::completions(program.app, line, nullptr);
    };
    CHECK(of("tester ce") == Words{"cert"});
    CHECK(of("tester cert ") == Words{"list"});
    CHECK(of("tester cert list --a") == Words{"--all"});
    CHECK(of("tester --lev") == Words{"--level"});
    CHECK(of("tester --level ") == Words{"low", "high"});
    CHECK(of("tester --level=h") == Words{"--level=high"});
    CHECK(of("tester --steps s") == Words{"second"});
    CHECK(of("tester --port 1 ce") == Words{"cert"});
    CHECK(of("tester -p ").empty());
    CHECK(of("").size() == 1);
    // What only the program knows; words are read as a shell reads them.
    command_line::CompletionPlace seen{&program.app};
    const auto note = [&seen](const command_line::CompletionPlace& place) {
        seen = place;
        return Words{"a b:c", "a d"};
    };
    CHECK(command_line::completions(program.app, "tester cert list 'x y' z\\ z \"a b", note) ==
          Words{"a b:c"});
    CHECK(seen.arguments == Words{"x y", "z z"});
    CHECK(seen.word == "a b");
    CHECK(seen.is_quoted);
    CHECK(seen.command->get_name() == "list");
    // bash keeps what is before a colon, but not in quotes.
    CHECK(command_line::completions(program.app, "tester cert list a\\ b:", note, ":=") ==
          Words{"c"});
    CHECK(command_line::completions(program.app, "tester cert list 'a b:", note, ":=") ==
          Words{"a b:c"});
}

} // namespace manual_page_test
