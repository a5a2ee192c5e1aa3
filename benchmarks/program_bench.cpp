// Reads a program of many variables in each format, and prints the processor time and the memory
// that this takes; then declarations of up to 50 MB.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <string_view>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/program_text.hpp>

#include "command_line/program_options.hpp"

namespace {

using namespace busbar::controller;
using Line = std::function<std::string(std::size_t index)>;

struct Format {
    const char* name;
    std::string_view before;
    Line line;
    std::string_view after;
};

std::string number(std::size_t index)
{
    return std::to_string(index);
}

const Format formats[] = {
    {"declarations", "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n",
     [](std::size_t i) { return "  Value" + number(i) + " : DINT := " + number(i) + ";\n"; },
     "END_VAR\n"},
    {"TwinCAT", "<TcPlcObject><GVL Name=\"G\"><Declaration><![CDATA[VAR_GLOBAL\n",
     [](std::size_t i) { return "  Value" + number(i) + " : DINT := " + number(i) + ";\n"; },
     "END_VAR]]></Declaration></GVL></TcPlcObject>\n"},
    {"PLCopen XML",
     "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><instances><configurations>"
     "<configuration name=\"C\"><globalVars>\n",
     [](std::size_t i) {
         return "<variable name=\"Value" + number(i) +
                "\"><type><DINT/></type><initialValue><simpleValue value=\"" + number(i) +
                "\"/></initialValue></variable>\n";
     },
     "</globalVars></configuration></configurations></instances></project>\n"},
    {"IEC 61131-10",
     "<Project xmlns=\"www.iec.ch/public/TC65SC65BWG7TF10\"><Instances><Configuration name=\"C\">"
     "<Resource name=\"R\"><GlobalVars>\n",
     [](std::size_t i) {
         return "<Variable name=\"Value" + number(i) +
                "\"><Type><TypeName>DINT</TypeName></Type><InitialValue><SimpleValue value=\"" +
                number(i) + "\"/></InitialValue></Variable>\n";
     },
     "</GlobalVars></Resource></Configuration></Instances></Project>\n"},
    {"Sysmac table", "",
     [](std::size_t i) {
         return "Value" + number(i) + "\tDINT\t" + number(i) + "\t\tFalse\tFalse\tPublish Only\t\n";
     },
     ""},
    {"GX Works list", "Class,Label Name,Data Type,Initial Value,Access from External Device\n",
     [](std::size_t i) {
         return "VAR_GLOBAL,Value" + number(i) + ",Double Word [Signed]," + number(i) + ",1\n";
     },
     ""},
};

std::string text_of(const Format& format, std::size_t variables)
{
    std::string text{format.before};
    for (std::size_t i = 0; i < variables; ++i) {
        text += format.line(i);
    }
    return text += format.after;
}

/// Reads and checks the text in a process of its own, so that its memory is that of this text.
void measure(const char* name, const std::string& text)
{
    std::fflush(stdout);
    const pid_t child = fork();
    if (child != 0) {
        int status = 0;
        waitpid(child, &status, 0);
        return;
    }
    struct rusage before {};
    getrusage(RUSAGE_SELF, &before);
    const std::clock_t begin = std::clock();
    auto read = read_program_text(text, "bench", {}, Unserved::LeaveOut);
    const std::clock_t middle = std::clock();
    const auto checked = std::move(read).and_then([](Program program) {
        return CheckedProgram::create(std::move(program), Unserved::LeaveOut);
    });
    const std::clock_t end = std::clock();
    struct rusage after {};
    getrusage(RUSAGE_SELF, &after);
    if (!checked) {
        std::printf("%-14s %s\n", name, busbar::text(checked.error()).c_str());
        std::exit(1);
    }
    const std::size_t variables = (*checked)->program().variables.size();
    const auto milliseconds = [](std::clock_t clocks) {
        return static_cast<double>(clocks) * 1e3 / CLOCKS_PER_SEC;
    };
    std::printf("%-14s %8zu variables %6.1f MB: read %7.1f ms, checked %7.1f ms, %6.0f ns each, "
                "%5ld MB more memory\n",
                name, variables, static_cast<double>(text.size()) / 1e6,
                milliseconds(middle - begin), milliseconds(end - middle),
                milliseconds(end - begin) * 1e6 / static_cast<double>(variables),
                (after.ru_maxrss - before.ru_maxrss) / 1024);
    std::fflush(stdout);
    std::_Exit(0);
}

} // namespace

int main(int argc, char** argv)
{
    std::size_t variables = 100'000;
    CLI::App app{
        "Reads a program of many variables in each format, and declarations of up to 50 MB, "
        "and prints the processor time and the memory that this takes."};
    app.add_option("variables", variables, "of the program")->capture_default_str();
    busbar::command_line::add_program_options(app, "busbar-program-bench");
    CLI11_PARSE(app, argc, argv);
    for (const Format& format : formats) {
        measure(format.name, text_of(format, variables));
    }
    for (const Format& format : formats) {
        for (const std::size_t megabytes : {5U, 10U, 25U, 50U}) {
            const std::size_t of_one = text_of(format, 1'000).size() / 1'000 + 6;
            measure(format.name, text_of(format, megabytes * 1'000'000 / of_one));
        }
    }
}
