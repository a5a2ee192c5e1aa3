#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "product/configuration/config.hpp"
#include "support/temporary_folder.hpp"

namespace config_test {

using namespace busbar;
using product::AccountAccess;
using product::ConfigError;
using product::ControllerConfig;

namespace {

ControllerConfig parse(const std::string& text)
{
    return product::parse_config(text, "plant.toml");
}

/// What the operator reads of a configuration that is wrong.
std::string complaint(const std::string& text)
{
    try {
        static_cast<void>(parse(text));
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "nothing";
}

std::string example_file(const std::string& name)
{
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR} + "/examples/controller/" + name};
    return {std::istreambuf_iterator<char>{file}, {}};
}

} // namespace

TEST_CASE("the configuration that programs have built in refuses what is insecure")
{
    const ControllerConfig config = parse(example_file("controller.toml"));
    REQUIRE(config.server.endpoints.size() == 2);
    for (const server::EndpointConfig& endpoint : config.server.endpoints) {
        CHECK_FALSE(endpoint.security.policy->is_none());
        CHECK_FALSE(endpoint.allows_anonymous);
    }
    CHECK_FALSE(config.certificates.trusts_all_clients);
    CHECK_FALSE(config.users.anonymous);
    CHECK_FALSE(config.users.certified);
    CHECK(config.key_log.empty());
    CHECK(config.certificates.valid_days == 7'305); // 20 years
}

TEST_CASE("an empty file is as secure")
{
    const ControllerConfig config = parse("");
    CHECK(config.server.endpoints.size() == 2);
    CHECK_FALSE(config.users.anonymous);
    CHECK_FALSE(config.certificates.trusts_all_clients);
}

TEST_CASE("the demo is on this machine only")
{
    CHECK(parse(example_file("demo.toml")).address == "127.0.0.1");
}

TEST_CASE("levels of events are configured, for those that may have another one")
{
    const auto levels = parse("[machine]\nevent_levels = [\"15000000 Observation\", "
                              "\"35d20000 minor fault\", \"35D10000 minor fault\"]")
                            .machine.event_levels;
    REQUIRE(levels.size() == 3);
    CHECK(levels[0].code == 0x15000000);
    CHECK(levels[0].level == controller::EventLevel::Observation);
    CHECK(levels[1].code == 0x35D20000);
    CHECK(levels[1].level == controller::EventLevel::MinorFault);
    CHECK(levels[2].level == controller::EventLevel::MinorFault);
    for (const char* wrong :
         {"44180000 Observation", "15000000 Information", "15000000", "", "x"}) {
        INFO(wrong);
        CHECK_THROWS_AS(parse("[machine]\nevent_levels = [\"" + std::string{wrong} + "\"]"),
                        ConfigError);
    }
}

TEST_CASE("address and port are configured", "[unit:Protocol Configuration]")
{
    CHECK(parse("").port == 4'840);
    const ControllerConfig config = parse("[server]\naddress = \"192.0.2.7\"\nport = 4841");
    CHECK(config.address == "192.0.2.7");
    CHECK(config.port == 4'841);
}

TEST_CASE("URLs of port maps are endpoints, and their hosts are in the certificate")
{
    const ControllerConfig config = parse(
        "[server]\nhost_names = [\"press-4\"]\nannounce = [\"opc.tcp://plant.example:30840\", "
        "\"opc.tcp://press-4:30841\"]\n");
    CHECK(config.server.further_urls ==
          std::vector<std::string>{"opc.tcp://plant.example:30840", "opc.tcp://press-4:30841"});
    CHECK(config.host_names == std::vector<std::string>{"press-4", "plant.example"});
    CHECK(parse("[server]\n").server.further_urls.empty());
}

TEST_CASE("certificates and users are configured", "[unit:Security Administration]")
{
    const ControllerConfig config = parse(R"(
[certificates]
folder = "pki"
key_bits = 3072
valid_days = 30
limits = "nj501"
suppress = ["find revocation list", "validity period"]
[[endpoint]]
policy = "Aes256_Sha256_RsaPss"
[users]
anonymous = "read"
certificates = "write"
)");
    CHECK(config.certificates.folder == "pki");
    CHECK(config.certificates.key_bits == 3072);
    CHECK(config.certificates.valid_days == 30);
    CHECK(config.certificates.limits.max_rejected == 32);
    CHECK(config.certificates.validation.suppress_find_revocation_list);
    CHECK(config.certificates.validation.suppress_validity_period);
    CHECK_FALSE(config.certificates.validation.suppress_host_name);
    CHECK(config.users.anonymous == AccountAccess::Read);
    CHECK(config.users.certified == AccountAccess::Write);
    REQUIRE(config.server.endpoints.size() == 1);
    CHECK(config.server.endpoints[0].allows_certificate);
    CHECK_FALSE(config.server.endpoints[0].allows_user_name);
    CHECK_FALSE(config.server.endpoints[0].allows_issued);
}

TEST_CASE("clients that the server connects to are configured")
{
    CHECK(parse("").reverse_urls.empty());
    const ControllerConfig config = parse(R"(
[reverse_connect]
urls = ["opc.tcp://scada:4841", "opc.tcp://[::1]:4842"]
)");
    CHECK(config.reverse_urls ==
          std::vector<std::string>{"opc.tcp://scada:4841", "opc.tcp://[::1]:4842"});
}

TEST_CASE("servers of the network are configured")
{
    const auto config = parse(R"([discovery]
[[discovery.server]]
name = "Press 2"
url = "opc.tcp://press-2:4840"
capabilities = ["DA", "HD"]
[[discovery.server]]
name = "Oven"
url = "opc.tcp://oven:4840"
)");
    REQUIRE(config.server.network_servers.size() == 2);
    CHECK(config.server.network_servers[0].name == "Press 2");
    CHECK(config.server.network_servers[0].capabilities == std::vector<std::string>{"DA", "HD"});
    CHECK(config.server.network_servers[1].discovery_url == "opc.tcp://oven:4840");
    const auto one = [](const std::string& line) {
        return complaint("[[discovery.server]]\nname = \"a\"\nurl = \"opc.tcp://a:1\"\n" + line);
    };
    CHECK(one("") == "nothing");
    CHECK(one("port = 3").find("port") != std::string::npos);
    CHECK(complaint("[[discovery.server]]\nname = \"\"\nurl = \"opc.tcp://a:1\"")
              .find("plant.toml:2") != std::string::npos);
    CHECK(
        complaint("[[discovery.server]]\nname = \"a\"\nurl = \"http://a\"").find("plant.toml:3") !=
        std::string::npos);
}

TEST_CASE("audit events are raised where the file says so")
{
    CHECK_FALSE(parse("").server.is_auditing);
    CHECK(parse("[server]\nauditing = true").server.is_auditing);
}

TEST_CASE("locales are languages with or without a country")
{
    CHECK(parse("").server.locale_ids == std::vector<std::string>{"en"});
    CHECK(parse("[server]\nlocales = [\"de-AT\", \"en\", \"es-419\"]").server.locale_ids ==
          std::vector<std::string>{"de-AT", "en", "es-419"});
    for (const char* wrong : {"e", "english", "en-", "-en", "en-USAX", "d\u00e9", "en-US-x"}) {
        CHECK(complaint("[server]\nlocales = [\"" + std::string{wrong} + "\"]")
                  .find("plant.toml:2") != std::string::npos);
    }
}

TEST_CASE("a discovery server is configured", "[unit:Discovery Configuration]")
{
    for (const std::string& none :
         {std::string{}, example_file("controller.toml"), std::string{"[discovery]\nurl = \"\""}}) {
        const auto discovery = parse(none).discovery;
        CHECK(discovery.url.empty());
        CHECK(discovery.interval == std::chrono::minutes{5});
        CHECK_FALSE(discovery.allows_none);
    }
    const ControllerConfig config = parse(R"(
[discovery]
url = "opc.tcp://lds:4840/UADiscovery"
interval_s = 600
allow_none = true
)");
    CHECK(config.discovery.url == "opc.tcp://lds:4840/UADiscovery");
    CHECK(config.discovery.interval == std::chrono::minutes{10});
    CHECK(config.discovery.allows_none);
}

TEST_CASE("what is wrong is told with its place, and what was expected")
{
    struct Row {
        std::string text;
        std::string said;
    };
    const Row rows[] = {
        {"[server]\nprot = 4840", "plant.toml:2: found \"prot\", expected one of: name"},
        {"[server]\nport = 70000", "plant.toml:2: port: found 70000, expected a number from 0"},
        {"[server]\nport = \"x\"", "plant.toml:2: port: found "},
        {"[server\nport = 1", "plant.toml:1: "},
        {"[reverse_connect]\nurls = [\"scada:4841\"]", "plant.toml:2: urls: found "},
        {"[reverse_connect]\nurl = \"opc.tcp://scada\"", "found \"url\", expected one of: urls"},
        {"[discovery]\nurl = \"lds:4840\"", "plant.toml:2: url: found "},
        {"[discovery]\ninterval_s = 9", "interval_s: found 9, expected a number from 10"},
        {"[discovery]\ninterval_s = 601", "interval_s: found 601"},
        {"[certificates]\nkey_bits = 1024", "plant.toml:2: key_bits: found 1024"},
        {"[certificates]\nlimits = \"nj\"", "expected default, nj501, nx102 or rd81opc96"},
        {"[certificates]\nsuppress = [\"trust list check\"]", "expected some of: security policy"},
        {"[[endpoint]]\npolicy = \"Basic128\"",
         "plant.toml:2: policy: found 'Basic128', expected one of: None"},
        {"[[endpoint]]\npolicy = \"None\"\nmode = \"Sign\"", "expected None, the only mode"},
        {"[users]\nauthorities = \"six\"", "authorities: found 'six', expected \"standard\" or"},
        {"[users]\nanonymous = \"all\"", "expected \"no\", \"read\" or \"write\""},
        {"[[users.account]]\nname = \"a\"\npassword = \"plain\"",
         "plant.toml:3: password: found no hash, expected the output of --hash-password"},
        {"[[users.account]]\nname = \"\"", "plant.toml:2: name: found '', expected a name"},
        {"[users.tokens]\nissuer = \"x\"\nkey_file = \"/nowhere\"", "a file that can be read"},
        {"[plc]\nscan_ms = 0", "plant.toml:2: scan_ms: found 0"},
        {"[[plc.variable]]\nname = \"A\"\ntype = \"Int\"", "expected a built-in type"},
    };
    for (const Row& row : rows) {
        INFO(row.text);
        const std::string said = complaint(row.text);
        INFO(said);
        CHECK(said.find(row.said) != std::string::npos);
    }
}

TEST_CASE("values without sense are refused with line, found, expected and remedy")
{
    const std::string twice = "[[plc.variable]]\nname = \"Running\"\ntype = \"Boolean\"\n";
    struct Row {
        std::string text;
        std::string said;
    };
    const Row rows[] = {
        {"[limits]\nmessage_size = 10",
         "plant.toml:2: message_size: found 10, expected a number from 8192 to 67108864"},
        {"[limits]\nmessage_size = 2000000000", "plant.toml:2: message_size: found 2000000000"},
        {"[limits]\nnodes_per_read = 2000000000",
         "plant.toml:2: nodes_per_read: found 2000000000, expected a number from 1 to 16777216"},
        {"[limits]\nnodes_per_read = 65537", "plant.toml:2: nodes_per_read: found 65537, expected "
                                             "at most 65535, one below the array_length: "
                                             "raise that one too"},
        {"[limits]\nconnections_per_address = 0", "plant.toml:2: connections_per_address: found 0"},
        {twice + twice, "plant.toml:5: name: found 'Running' again, expected a name of its own"},
        {twice + "initial = 5.0",
         "plant.toml:4: initial: found 5.0, expected a value that Boolean"},
        {twice + "[[plc.program]]\nkind = \"sine\"\ntarget = \"Runing\"\nperiod_ms = 1",
         "plant.toml:6: target: found 'Runing', expected a variable's name"},
        {"[[plc.variable]]\nname = \"A\"\ntype = \"Double\"\n[[plc.program]]\nkind = \"sine\"\n"
         "target = \"A\"\nperiod_ms = 0",
         "plant.toml:7: period_ms: found 0 ms, expected more than 0"},
        {"[plc]\nwaiting_writes = 0", "plant.toml:2: waiting_writes: found 0"},
        {"[server]\naddress = \"localhost\"",
         "plant.toml:2: address: found 'localhost', expected an IPv4 or IPv6 address"},
        {"[server]\nhost_names = [\"opc.tcp://plc\"]", "plant.toml:2: host_names: found "},
        {"[server]\nhost_names = [\"plc:4840\"]", "expected names and addresses without scheme"},
        {"[server]\nhost_names = [\"\"]", "expected names and addresses without scheme"},
        {"[server]\nannounce = [\"plant.example:30840\"]", "plant.toml:2: announce: found "},
        {"[server]\nannounce = [\"opc.tcp://\"]", "expected opc.tcp://host:port of each port map"},
    };
    for (const Row& row : rows) {
        INFO(row.text);
        const std::string said = complaint(row.text);
        INFO(said);
        CHECK(said.starts_with("plant.toml:"));
        CHECK(said.find(row.said) != std::string::npos);
        CHECK(said.find("expected expected") == std::string::npos);
        CHECK(said.find("expected found") == std::string::npos);
    }
}

TEST_CASE("characters that TOML has in strings and comments only are refused elsewhere")
{
    const auto parse = [](const std::string& text) {
        static_cast<void>(product::parse_table(text, "plant.toml"));
    };
    for (const char* text : {"a = \"\u00E4\" # \u00E4\n", "a = '\u00E4'\n", "\uFEFFa = 1\n",
                             "a = \"\"\"\n\u00E4\\\"\"\"\"\n", "a = '''\n\u00E4'''\n",
                             "a = \"\"\"b \\\n  \u00E4\"\"\"\n", "\"\u00E4\" = \"\\\"\u00E4\"\n"}) {
        CAPTURE(text);
        CHECK_NOTHROW(parse(text));
    }
    // toml++ has undefined behaviour for some behind numbers.
    for (const char* text :
         {"a = 1\nb = 5\u00B5\n", "a = \"b\"\n\u00E4 = 1\n",
          "a = \"\\\"\" # \u00E4\nb = 0\u01FC9\n", "a = ''\nb = '''c'''\u00E4\n"}) {
        CAPTURE(text);
        CHECK_THROWS_WITH(parse(text),
                          Catch::Contains("plant.toml:2: found a character that is not ASCII"));
    }
}

TEST_CASE("characters behind what no string begins with, or no escape, are refused")
{
    for (const char* text : {"a = 1\nb = 0\"\u01FC9\n", "a = 1\nb = \"\"\"\\\u00E4\"\"\"\n"}) {
        CAPTURE(text);
        CHECK_THROWS_WITH(product::parse_table(text, "plant.toml"),
                          Catch::Contains("plant.toml:2: "));
    }
}

TEST_CASE("texts that toml++ cannot cope with are refused with their line")
{
    const auto parse = [](const std::string& text) {
        static_cast<void>(product::parse_table(text, "plant.toml"));
    };
    CHECK_THROWS_WITH(parse("[#"), Catch::Contains("plant.toml:1: found text that is not TOML"));
    CHECK_THROWS_WITH(parse("a = 1\n[b]\nc = 2\n[#]\n[d]\ne = 3\n"),
                      Catch::Contains("plant.toml:4: found text that is not TOML"));
}

TEST_CASE("a configuration that cannot be read says why")
{
    const auto complaint_of = [](const std::string& path) -> std::string {
        try {
            static_cast<void>(product::read_config(path));
        } catch (const ConfigError& error) {
            return error.what();
        }
        return "nothing";
    };
    CHECK(complaint_of(BUSBAR_SOURCE_DIR) == BUSBAR_SOURCE_DIR
          ": found a directory, expected a file; --print-config prints one");
    CHECK(complaint_of("/nowhere/plant.toml") ==
          "/nowhere/plant.toml: the file cannot be read: No such file or directory");
    CHECK(complaint_of("/dev/zero").find("expected a configuration") != std::string::npos);
}

TEST_CASE("a variable goes through the limits, or is refused")
{
    const auto array = [](const std::string& more) {
        return "[[plc.variable]]\nname = \"A\"\ntype = \"Double\"\n" + more;
    };
    CHECK(complaint(array("dimensions = [300000]")) ==
          "plant.toml:4: dimensions: found 300000 elements, expected at most 65536: raise "
          "array_length in [limits], or no client could write all of it");
    CHECK(complaint(array("dimensions = [300, 300]")).find("found 90000 elements") !=
          std::string::npos);
    CHECK(complaint(array("dimensions = [65536]")) == "nothing");
    const std::string raised = "[limits]\narray_length = 3000000\n";
    CHECK(complaint(raised + array("dimensions = [300000]")) == "nothing");
    CHECK(complaint(raised + array("dimensions = [3000000]")).find("raise message_size") !=
          std::string::npos);
    CHECK(complaint(raised + "message_size = 30000000\n" + array("dimensions = [3000000]")) ==
          "nothing");
    const ControllerConfig config = parse(raised + "[[plc.variable]]\nname = \"T\"\n"
                                                   "type = \"String\"\ndimensions = [100000]");
    CHECK(config.server.limits.decode.max_array_length == 3'000'000);
    CHECK(config.image.max_changes_per_scan >= 100'000); // a text is a change
    CHECK(complaint("[limits]\nstring_length = 256\n[[plc.variable]]\nname = \"T\"\n"
                    "type = \"String\"\ncapacity = 300")
              .find("capacity: found 300 bytes, expected at most 256: raise string_length") !=
          std::string::npos);
}

TEST_CASE("what holds messages grows with them")
{
    const ControllerConfig config = parse("[limits]\nmessage_size = 67108864");
    CHECK(config.server.limits.max_assembly >= std::size_t{2} * 67'108'864);
    CHECK(config.server.limits.max_send_queue >= std::size_t{2} * 67'108'864);
    CHECK(config.server.limits.transport.max_chunk_count * std::uint64_t{65'535} > 67'108'864);
}

TEST_CASE("waiting Writes and connections of an address have keys")
{
    const ControllerConfig config =
        parse("[limits]\nconnections_per_address = 100\n[plc]\nwaiting_writes = 5000");
    CHECK(config.server.limits.max_connections_per_address == 100);
    CHECK(config.image.max_waiting_writes == 5'000);
}

TEST_CASE("a password that is none is not shown in the error")
{
    CHECK(complaint("[[users.account]]\nname = \"a\"\npassword = \"hunter2\"").find("hunter2") ==
          std::string::npos);
}

TEST_CASE("folders whose files clients see are configured")
{
    const auto config = parse("[[files]]\nname = \"recipes\"\nfolder = \"r\"\n"
                              "[[files]]\nname = \"logs\"\nfolder = \"l\"\nreaders = []\n"
                              "writers = [\"Engineer\"]\nfile_size = 40000000\nentries = 5");
    REQUIRE(config.files.size() == 2);
    CHECK(config.files[0].readers.size() == 3);
    CHECK(config.files[0].writers == std::vector<std::string>{"ConfigureAdmin"});
    CHECK(config.files[1].readers.empty());
    CHECK(config.files[1].limits.max_file_size == 40'000'000);
    CHECK(config.files[1].limits.max_written == 80'000'000);
    CHECK(config.files[1].limits.max_entries == 5);

    const std::string start =
        "[certificates]\nfolder = \"pki\"\n[[files]]\nname = \"a\"\nfolder = ";
    const std::pair<std::string, const char*> mistakes[] = {
        {start + "\"pki\"", "plant.toml:5: folder: found \"pki\", expected one apart from"},
        {start + "\".\"", "which has keys in it"},
        {start + "\"./pki/own\"", "which has keys in it"},
        {start + "\"x/../pki/\"", "which has keys in it"},
        {start + "\"\"", "expected a folder"},
        {start + "\"f\"\nreaders = [\"Boss\"]", "expected some of: Observer"},
        {start + "\"f\"\n[[files]]\nname = \"a\"\nfolder = \"g\"", "found \"a\" again"},
        {start + "\"f\"\n[[files]]\nname = \"b\"\nfolder = \"f/g\"", "one apart from \"f\" of a"},
        {"[[files]]\nname = \"a/b\"\nfolder = \"f\"", "1 to 63 letters"},
    };
    for (const auto& [text, said] : mistakes) {
        INFO(text);
        INFO(complaint(text));
        CHECK(complaint(text).find(said) != std::string::npos);
    }
    CHECK_NOTHROW(parse(start + "\"pki2\"")); // a part of the name is no part of the path
}

TEST_CASE("clients get no folder in which a machine keeps its own files", "[attack]")
{
    const test::TemporaryFolder folder;
    const std::string program = folder.path.string() + "/press.st";
    std::ofstream{program} << "VAR_GLOBAL\n  speed : INT;\nEND_VAR\n";
    const auto with = [&](const char* files, const char* machine = "") {
        return std::string{"[machine]\nprogram = \""} + program + "\"\nmedium = \"card\"\n" +
               "state = \"kept\"\n" + machine + "[[files]]\nname = \"a\"\nfolder = \"" + files +
               "\"\n";
    };
    for (const char* const taken :
         {"kept", "kept/events", "./kept/", "card", "card/packages", "card/packages/OPCUA_Server",
          "card/packages/OPCUA_Server/ExecutionLog", "x/../card"}) {
        INFO(taken << ": " << complaint(with(taken)));
        CHECK(complaint(with(taken)).find("where the machine keeps its own files") !=
              std::string::npos);
    }
    CHECK(complaint(with(folder.path.c_str())).find("the machine's program") != std::string::npos);
    const std::string here =
        "certificates.folder = \"/elsewhere/pki\"\n[[files]]\nname = \"a\"\nfolder = \".\"\n";
    CHECK(complaint(here).find("\"plant.toml\", the configuration") != std::string::npos);
    CHECK_NOTHROW(parse(with("card/recipes")));
    CHECK_NOTHROW(parse(with("keptwell")));
}

namespace {

/// A folder with files that a configuration names, beside one for clients.
struct NamedFiles {
    struct Row {
        std::string text;
        std::string files;
        std::string said;
    };

    [[nodiscard]] std::string at(const std::string& name) const
    {
        return folder.path.string() + "/" + name;
    }
    void write(const std::string& name, const std::string& text) const
    {
        std::filesystem::create_directories(std::filesystem::path{at(name)}.parent_path());
        std::ofstream{at(name)} << text;
    }
    [[nodiscard]] std::string with(const std::string& text, const std::string& files) const
    {
        return text + "\n[[files]]\nname = \"a\"\nfolder = \"" + at(files) + "\"\n";
    }
    void check(std::span<const Row> rows) const
    {
        for (const auto& [text, files, said] : rows) {
            INFO(text << "\n" << files << ": " << complaint(with(text, files)));
            CHECK(complaint(with(text, files)).find(said) != std::string::npos);
        }
    }

    test::TemporaryFolder folder;
};

} // namespace

TEST_CASE_METHOD(NamedFiles,
                 "clients get no folder with a file of a program or the password of a PLC",
                 "[attack]")
{
    write("p/x.st", "VAR_GLOBAL\n  speed : INT;\nEND_VAR\n");
    write("files/b.st", "VAR_GLOBAL\n  level : INT;\nEND_VAR\n");
    write("q/GVLs/A.TcGVL",
          "<TcPlcObject><GVL Name=\"A\"><Declaration><![CDATA[VAR_GLOBAL a : INT; "
          "END_VAR]]></Declaration></GVL></TcPlcObject>");
    write("q/q.plcproj", "<Project><ItemGroup><Compile Include=\"GVLs\\A.TcGVL\"/></ItemGroup>"
                         "</Project>");
    std::filesystem::copy_file(at("q/q.plcproj"), at("q/line.xml"));
    write("secrets/plc.password", "secret\n");
    const std::string list = "[\"" + at("p/x.st") + "\", \"" + at("files/b.st") + "\"]";
    const std::string project = "\"" + at("q/q.plcproj") + "\"";
    const std::string slmp = "address = \"192.0.2.20:5000\"\nremote_password_file = \"" +
                             at("secrets/plc.password") + "\"\n";
    const std::string machine = "the machine's program";
    const std::string labels = "the program of the labels";
    const Row rows[] = {
        {"[machine]\nprogram = " + list, "files", at("files/b.st") + "\", " + machine},
        {"[machine]\nprogram = " + list, "p", at("p/x.st") + "\", " + machine},
        {"[machine]\nprogram = " + project, "q/GVLs", at("q") + "\", " + machine},
        {"[machine]\nprogram = [" + project + "]", "q/GVLs", at("q") + "\", " + machine},
        {"[machine]\nprogram = \"" + at("q/line.xml") + "\"", "q/GVLs", at("q") + "\", " + machine},
        {"[labels]\nprogram = \"" + at("files/b.st") + "\"", "files", labels},
        {"[labels]\nprogram = " + list, "p", labels},
        {"[labels]\nprogram = " + project, "q/GVLs", labels},
        {"[labels]\nbackend = \"slmp\"\n" + slmp, "secrets", "the password of a PLC"},
        {"[[backend]]\nname = \"press\"\nprotocol = \"slmp\"\n" + slmp, "secrets",
         "the password of a PLC"},
    };
    check(rows);
    for (const Row& each : rows) {
        CHECK(complaint(with(each.text, "recipes")) == "nothing");
    }
}

TEST_CASE_METHOD(NamedFiles, "clients get no folder with another file that is named, nor by a link",
                 "[attack]")
{
    write("p/x.st", "VAR_GLOBAL\n  speed : INT;\nEND_VAR\n");
    write("files/b.st", "VAR_GLOBAL\n  level : INT;\nEND_VAR\n");
    write("secrets/plc.password", "secret\n");
    const std::string machine = "the machine's program";
    const std::string slmp = "address = \"192.0.2.20:5000\"\nremote_password_file = \"" +
                             at("secrets/plc.password") + "\"\n";
    write("models/m.xml", "");
    write("plc/press.csv", "name,at,access\nSpeed,holding:0:int16,write\n");
    std::filesystem::create_symlink(at("p/x.st"), at("files/link.st"));
    std::filesystem::create_symlink(at("files"), at("linked"));
    std::filesystem::create_directories(at("secrets/deep"));
    std::filesystem::create_directories(at("sub"));
    std::filesystem::create_symlink(at("secrets/deep"), at("sub/led"));
    const Row further[] = {
        {"[server]\nnodesets = [\"" + at("models/m.xml") + "\"]", "models", "an information model"},
        {"[[backend]]\nname = \"press\"\nprotocol = \"modbus\"\naddress = \"192.0.2.20:502\"\n"
         "table = \"" +
             at("plc/press.csv") + "\"",
         "plc", "the addresses of a PLC"},
        {"[machine]\nprogram = \"" + at("files/link.st") + "\"", "files", machine},
        {"[machine]\nprogram = \"" + at("files/link.st") + "\"", "p", machine},
        {"[machine]\nprogram = \"" + at("files/link.st") + "\"", "linked", machine},
        {"[machine]\nprogram = \"" + at("linked/b.st") + "\"", "files", machine},
        {"[[backend]]\nname = \"press\"\nprotocol = \"slmp\"\n" + slmp, "sub/led/..",
         "the password of a PLC"},
    };
    check(further);
}

TEST_CASE("names that become nodes have at most 512 bytes, and the file's line is told")
{
    const auto with = [](const std::string& before, std::size_t size) {
        return before + " = \"" + std::string(size, 'n') + "\"\n";
    };
    for (const std::string before :
         {"[server]\nname", "[machine]\nname", "[[plc.variable]]\ntype = \"Int16\"\nname"}) {
        INFO(before);
        CHECK_NOTHROW(product::parse_config(with(before, 512), "test.toml"));
        CHECK_THROWS_WITH(product::parse_config(with(before, 513), "test.toml"),
                          Catch::StartsWith("test.toml:") &&
                              Catch::Contains("name: found a name of 513 bytes, expected at most "
                                              "512"));
    }
    // Of many variables the last has the longest name.
    const std::string many = "[[plc.variable]]\ntype = \"Int16\"\ncount = 101\nname";
    CHECK_NOTHROW(product::parse_config(with(many, 509), "test.toml"));
    CHECK_THROWS_WITH(product::parse_config(with(many, 510), "test.toml"),
                      Catch::Contains("513 bytes"));
}

} // namespace config_test
