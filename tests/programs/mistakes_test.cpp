#include <catch2/catch.hpp>

#include <sys/stat.h>

#include "programs/controllers.hpp"

namespace mistakes_test {

// What people get wrong on the command line, and the line that helps them.

using namespace busbar;
using namespace busbar::test;

namespace {

struct Mistake {
    const char* what;
    /// For a shell in a folder of its own. $OPEN, $SECURE, $EXPIRED, $EARLY and $OTHER are URLs of
    /// servers, $PORT is the port of the first one, $LOGIN the right login of all but that one. All
    /// their certificates but that of $SECURE are trusted.
    const char* command;
    int exit;
    /// In what was printed, however it was broken into lines; empty: nothing at all is printed.
    const char* line;
};

constexpr Mistake mistakes[] = {
    // The server.
    {"host that does not exist", "busbar read opc.tcp://no-such-host.invalid:4840 i=2258", 3,
     "the host has no address: Bad_CommunicationError"},
    {"port at which nothing listens", "busbar read opc.tcp://localhost:1 i=2258", 3,
     "Connection refused: Bad_CommunicationError"},
    {"the same, asked for endpoints", "busbar endpoints opc.tcp://localhost:1", 3,
     "nothing listens at this port"},
    {"port that is no number", "busbar read opc.tcp://localhost:48611x i=2258", 2,
     "its port is \"48611x\", expected a number from 1 to 65535"},
    {"port without scheme that is no number", "busbar read localhost:48611x i=2258", 2,
     "its port is \"48611x\", expected a number from 1 to 65535"},
    {"port that is too large", "busbar discover opc.tcp://localhost:70000", 2,
     "its port is \"70000\", expected a number from 1 to 65535"},
    {"URL without scheme: it is understood",
     "busbar read --value localhost:$PORT 'ns=2;s=Serial' --insecure", 0, "BB-0001"},
    {"URL behind a node", "busbar read i=2258 $OPEN --insecure", 2,
     "a server, opc.tcp://host:4840, comes before all nodes"},
    {"URL of another protocol", "busbar read http://localhost:$PORT i=2258", 2,
     "http is not supported"},
    // Security.
    {"policy that does not exist", "busbar read $OPEN i=2258 --insecure --policy Basic256Sha512", 2,
     "Basic256Sha512 is not a security policy, perhaps Basic256Sha256 is meant; there are"},
    {"policy that the server lacks",
     "busbar read $SECURE i=2258 $LOGIN --policy Aes256_Sha256_RsaPss", 4,
     "the server has no endpoint for UA TCP with a security policy that we accept"},
    {"server without security", "busbar read $OPEN i=2258", 4, "--insecure allows none at all"},
    {"server that is not known", "busbar read $SECURE i=2258 $LOGIN", 4, "`busbar cert trust "},
    {"certificate that has expired", "busbar read $EXPIRED i=2258 $LOGIN", 4,
     "or do without this check: --ignore validity-period"},
    {"certificate that is not valid yet: a clock is wrong", "busbar read $EARLY i=2258 $LOGIN", 4,
     "not valid before"},
    {"certificate for another host", "busbar read $OTHER i=2258 $LOGIN", 4,
     "connected to localhost, but its host names are: plc.example"},
    {"the same: the switch is named", "busbar read $OTHER i=2258 $LOGIN", 4,
     "or do without this check: --ignore host-name"},
    {"the same, let pass: it is said",
     "busbar read $OTHER i=2258 $LOGIN --ignore host-name > out; code=$?; cat out; exit $code", 0,
     "busbar: warning: --ignore host-name: connected to localhost"},
    {"another step let pass", "busbar read $EXPIRED i=2258 $LOGIN --ignore validity-period", 0,
     "busbar: warning: --ignore validity-period: expired"},
    {"step that cannot be let pass", "busbar read $OTHER i=2258 --ignore hostname", 2,
     "perhaps host-name is meant; there are host-name, validity-period,"},
    // Users and files.
    {"no user where one is needed", "busbar read $SECURE i=2258", 4,
     "log in with --user and --password-file"},
    {"wrong password",
     "echo wrong > wrong; busbar read $EXPIRED i=2258 --ignore validity-period --user operator "
     "--password-file wrong",
     4, "the user may not do this, or name or password are wrong"},
    {"file that is missing", "busbar read $SECURE i=2258 --user x --password-file nothing", 1,
     "nothing: cannot be read: No such file or directory"},
    {"file that may not be read",
     "touch mine; chmod 0 mine; busbar read $SECURE i=2258 --user x --password-file mine", 1,
     "mine: cannot be read: Permission denied"},
    {"folder instead of a file", "busbar cert trust ./", 1, "./: cannot be read: Is a directory"},
    {"file that cannot be written", "busbar export $OPEN 1 --insecure -o nowhere/x.xml", 1,
     "nowhere/x.xml: cannot be written: No such file or directory"},
    // Nodes and values.
    {"node that is written wrong", "busbar read $OPEN 'ns=2,s=Mode' --insecure", 2,
     "this is not a node id"},
    {"node that does not exist", "busbar read $OPEN 'ns=2;s=Nothing' --insecure", 1,
     "the server has no such node"},
    {"path that fits two nodes", "busbar read $OPEN /Objects/Oven/Heat --insecure", 1,
     "hint: give one of these instead /Objects/3:Oven/Heat /Objects/4:Oven/Heat"},
    {"the same beside a good one", "busbar read $OPEN i=2258 /Objects/Oven/Heat --insecure", 5,
     "busbar: /Objects/Oven/Heat may be /Objects/3:Oven/Heat /Objects/4:Oven/Heat"},
    {"the same, written", "busbar write $OPEN /Objects/Oven/Heat 7 --insecure", 1,
     "give one of these instead /Objects/3:Oven/Heat /Objects/4:Oven/Heat"},
    {"the same, watched", "busbar watch $OPEN /Objects/Oven/Heat --insecure", 1,
     "give one of these instead /Objects/3:Oven/Heat /Objects/4:Oven/Heat"},
    {"the same for a script", "busbar browse $OPEN /Objects/Oven --insecure --json", 1,
     "\"candidates\":[\"/Objects/3:Oven\",\"/Objects/4:Oven\"]"},
    {"one of these paths", "busbar read $OPEN /Objects/4:Oven/Heat --insecure --value", 0, "230"},
    {"path without a name: the root", "busbar browse $OPEN / --depth 1 --insecure", 0, "Types"},
    {"type that does not exist", "busbar write $OPEN 'ns=2;s=Mode' 1 --type Int33 --insecure", 2,
     "Int33: not a built-in type"},
    {"value of another type", "busbar write $OPEN 'ns=2;s=Mode' fast --insecure", 2,
     "ns=2;s=Mode: expected a Byte, 0 to 255, found"},
    {"value out of range", "busbar write $OPEN 'ns=2;s=Mode' 300 --insecure", 2,
     "ns=2;s=Mode: expected a Byte, 0 to 255, found \"300\""},
    {"value that looks like an option", "busbar write $OPEN 'ns=2;s=Mode' --insecure -- -40000", 2,
     "expected a Byte, 0 to 255, found \"-40000\""},
    {"audit events of a server that raises none", "busbar admin audit $OPEN --insecure", 1,
     "the server raises no audit events, as its Auditing is false hint: have it raise them: a "
     "busbar-controller does after `busbar admin setting set server.auditing true`"},
    {"node that may only be read", "busbar write $OPEN 'ns=2;s=Serial' x --insecure", 1,
     "the value may not be written"},
    {"attribute that does not exist", "busbar read $OPEN i=2258 -a Valeu --insecure", 2,
     "did you mean Value?"},
    {"too few arguments of a method", "busbar call $OPEN i=2253 i=11492 --insecure", 2,
     "its arguments are: SubscriptionId (UInt32)"},
    // The machine.
    {"no HOME", "env -u HOME busbar read $SECURE i=2258 $LOGIN", 2, "HOME is not set"},
    {"no HOME where no certificate is needed",
     "env -u HOME busbar read --value $OPEN 'ns=2;s=Serial' --insecure", 0, "BB-0001"},
    {"HOME that may not be written", "mkdir h; chmod 500 h; HOME=h busbar read $SECURE i=2258", 1,
     "give another folder: --pki DIR"},
    {"the same where no certificate is needed",
     "mkdir h; chmod 500 h; HOME=h busbar read --value $OPEN 'ns=2;s=Serial' --insecure", 0,
     "BB-0001"},
    {"output that is full", "busbar read $OPEN i=2258 --insecure > /dev/full", 1,
     "the output cannot be written: No space left on device"},
    {"the same, of --help", "busbar --help > /dev/full", 1,
     "the output cannot be written: No space left on device"},
    {"the same, with the error itself", "busbar read $OPEN x --json > /dev/full", 1,
     "the output cannot be written: No space left on device"},
    {"pipe whose reader has gone",
     "{ busbar subscribe $OPEN i=2258 --interval 50 --insecure 2> /dev/null; echo $? > code; } | "
     "head -1 > first; exit $(cat code)",
     0, ""},
    {"Ctrl+C",
     "busbar subscribe $OPEN 'ns=2;s=Mode' --insecure > out 2> err & until grep -qs Mode out; do "
     "sleep 0.1; done; kill -INT $!; wait $!",
     130, ""},
    // The command line.
    {"nothing", "busbar", 2, "Looks into OPC UA servers"},
    {"command that is misspelt", "busbar raed i=2258", 2,
     "raed: not a command hint: did you mean `busbar read`?"},
    {"command within a command that is misspelt", "busbar cert lsit", 2,
     "did you mean `busbar cert list`?"},
    {"URL without a command", "busbar opc.tcp://localhost:4840", 2, "a command must come first"},
    {"option that is misspelt", "busbar read i=2258 --insecrue", 2,
     "--insecrue: not an option of `busbar read` hint: did you mean --insecure?"},
    {"option without its value", "busbar read i=2258 --timeout", 2,
     "`busbar read --help` tells more"},
    {"one argument too many", "busbar discover localhost:1 localhost:2", 2,
     "localhost:2: one argument too many"},
    // The controller.
    {"configuration without --config", "busbar-controller line.toml", 2,
     "line.toml: not expected here hint: busbar-controller --config line.toml"},
    {"option of the controller that is misspelt", "busbar-controller --confg x.toml", 2,
     "--confg: not expected here"},
    {"configuration that is missing", "busbar-controller --config nothing.toml", 1,
     "nothing.toml: the file cannot be read: No such file or directory"},
    {"configuration that is a folder", "busbar-controller --config .", 1, "found a directory"},
    {"configuration that may not be read",
     "touch secret.toml; chmod 0 secret.toml; busbar-controller --config secret.toml", 1,
     "secret.toml: the file cannot be read: Permission denied"},
    {"key of the configuration that is misspelt",
     "printf '[server]\\nprot = 4840\\n' > c.toml; busbar-controller --config c.toml", 1,
     "c.toml:2: found \"prot\", expected one of: name,"},
    {"port of the controller that is in use",
     "printf '[server]\\naddress = \"127.0.0.1\"\\nport = %s\\n[[endpoint]]\\npolicy = \"None\"\\n"
     "[users]\\nanonymous = \"read\"\\n' $PORT > c.toml; busbar-controller --config c.toml",
     1, "Address already in use"},
};

/// Blanks and ends of lines as one blank each.
std::string squeezed(const std::string& text)
{
    std::string result;
    for (const char character : text) {
        const bool is_blank = character == ' ' || character == '\n';
        if (!is_blank || (!result.empty() && result.back() != ' ')) {
            result += is_blank ? ' ' : character;
        }
    }
    return result;
}

/// A NodeSet2 file with an Oven below Objects, and Heat below that.
std::string oven_model(const std::string& uri)
{
    return R"(<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
<NamespaceUris><Uri>)" +
           uri + R"(</Uri></NamespaceUris>
<Models><Model ModelUri=")" +
           uri + R"(" Version="1.0.0" PublicationDate="2026-01-01T00:00:00Z"/></Models>
<UAObject NodeId="ns=1;s=Oven" BrowseName="1:Oven"><DisplayName>Oven</DisplayName><References>
<Reference ReferenceType="i=40">i=61</Reference>
<Reference ReferenceType="i=35" IsForward="false">i=85</Reference></References></UAObject>
<UAVariable NodeId="ns=1;s=Heat" BrowseName="1:Heat" DataType="i=6"><DisplayName>Heat</DisplayName>
<References><Reference ReferenceType="i=40">i=63</Reference>
<Reference ReferenceType="i=47" IsForward="false">ns=1;s=Oven</Reference></References>
<Value><Int32 xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">230</Int32></Value>
</UAVariable></UANodeSet>
)";
}

/// Without security, and with two Ovens.
std::string two_ovens(const ScratchFolder& scratch)
{
    const std::string one = scratch.write("oven1.xml", oven_model("urn:ovens:one"));
    const std::string two = scratch.write("oven2.xml", oven_model("urn:ovens:two"));
    return "nodesets = [\"" + one + "\", \"" + two + "\"]\n" + open_configuration();
}

/// All servers that the table needs.
class Plant {
public:
    Plant()
    {
        const auto trusted = [&](const std::string& name, const ServerCertificate& certificate) {
            return install_certificate(scratch, name, certificate);
        };
        const std::string files[] = {
            trusted("expired", {"localhost", in_days_from_now(-40), 30}),
            trusted("early", {"localhost", in_days_from_now(10), 30}),
            trusted("other", {"plc.example", in_days_from_now(-1), 30}),
        };
        install_certificate(scratch, "secure", {"localhost", in_days_from_now(-1), 30});
        scratch.write("password", "Long-Password-123\n");
        environment = {{"HOME", scratch.path() + "/home"},
                       {"LC_ALL", "C"},
                       {"PORT", open.port()},
                       {"OPEN", open.url()},
                       {"LOGIN", "--user operator --password-file " + scratch.path() + "/password"},
                       {"PATH", BUSBAR_PROGRAMS ":/usr/bin:/bin"}};
        for (const char* name : {"secure", "expired", "early", "other"}) {
            servers.push_back(std::make_unique<Controller>(scratch, name, configuration));
            std::string variable;
            for (const char* letter = name; *letter != '\0'; ++letter) {
                variable += static_cast<char>(*letter - 'a' + 'A');
            }
            environment.emplace_back(variable, servers.back()->url());
        }
        for (const std::string& file : files) {
            run("busbar cert trust " + file, scratch.path());
        }
    }

    struct End {
        int exit;
        std::string output;
    };
    End run(const std::string& command, const std::string& folder)
    {
        Program program{
            {"/bin/sh", "-c", command}, folder, scratch.path() + "/output", environment};
        const int exit = program.wait_for_end();
        return {exit, program.output()};
    }

    ScratchFolder scratch;
    Controller open{scratch, "open", two_ovens(scratch)};
    std::string configuration{secure_configuration()};
    std::vector<std::unique_ptr<Controller>> servers;
    Environment environment;
};

} // namespace

TEST_CASE("each mistake of a user ends with a line that helps")
{
    static_assert(std::size(mistakes) >= 25);
    Plant plant;
    int number = 0;
    for (const Mistake& mistake : mistakes) {
        const std::string folder = plant.scratch.path() + "/row" + std::to_string(++number);
        REQUIRE(::mkdir(folder.c_str(), 0700) == 0);
        const Plant::End end = plant.run(mistake.command, folder);
        INFO(mistake.what << "\n$ " << mistake.command << "\n" << end.output);
        CHECK(end.exit == mistake.exit);
        const std::string output = squeezed(end.output);
        const std::string_view line{mistake.line};
        CHECK((line.empty() ? output.empty() : output.find(line) != std::string::npos));
    }
}

} // namespace mistakes_test
