#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

#include <busbar/server/conformance.hpp>
#include <busbar/types/ids.hpp>

namespace conformance_test {

using namespace busbar;
using server::assess;
using server::Conformance;
using server::ConformanceFacts;
using server::ProfileAssessment;

namespace {

/// A server with everything, and variables of Data Access.
ConformanceFacts everything()
{
    ConformanceFacts facts;
    facts.namespace0 = server::Namespace0Size::Full;
    facts.methods = facts.events = facts.node_management = facts.diagnostics = true;
    facts.triggering = facts.transfer = true;
    facts.tcp = facts.reverse_connect = facts.discovery = true;
    facts.users_anonymous = facts.users_password = facts.users_certificate = true;
    facts.users_issued = facts.users_unencrypted = true;
    facts.policy_none = facts.policy_basic256sha256 = true;
    facts.policy_aes128 = facts.policy_aes256 = true;
    facts.sessions = 50;
    facts.channels = 51;
    facts.subscriptions = facts.publish = facts.continuation_points = 10;
    facts.items = 500;
    facts.queue = 5;
    facts.instance_types = {id::BaseDataVariableType, id::DataItemType, id::AnalogItemType,
                            id::NodeVersion};
    std::sort(facts.instance_types.begin(), facts.instance_types.end());
    return facts;
}

bool is_claimed(const ConformanceFacts& facts, std::string_view profile)
{
    const Conformance conformance = assess(facts);
    const ProfileAssessment* found = conformance.find(profile);
    REQUIRE(found != nullptr);
    CHECK(found->is_claimed == found->lacks.empty());
    return found->is_claimed;
}

/// "unit: need" of the first unit that the profile lacks.
std::string first_lack(const ConformanceFacts& facts, std::string_view profile)
{
    const Conformance conformance = assess(facts);
    const auto& lacks = conformance.find(profile)->lacks;
    return lacks.empty() ? std::string{}
                         : std::string{lacks[0].unit} + ": " + std::string{lacks[0].need};
}

std::set<std::string_view> units_of(const ConformanceFacts& facts)
{
    const Conformance conformance = assess(facts);
    return {conformance.units.begin(), conformance.units.end()};
}

} // namespace

TEST_CASE("a server with everything claims the profiles up to Standard 2017")
{
    for (const char* const profile : {"Core2017Server",
                                      "Nano2017Server",
                                      "Micro2017Server",
                                      "Embedded2017Server",
                                      "Standard2017Server",
                                      "StandardEventSubscription",
                                      "StandardDataChangeSubscription2017",
                                      "EnhancedDataChangeSubscription2017",
                                      "DataAccess",
                                      "ComplexTypes2017",
                                      "Methods",
                                      "NodeManagement",
                                      "ModelChangeEvent",
                                      "TransportUaTcp",
                                      "SecurityPolicyNone",
                                      "SecurityPolicyBasic256Sha256",
                                      "SecurityPolicyAes128Sha256RsaOaep",
                                      "SecurityPolicyAes256Sha256RsaPss",
                                      "UserTokenX509CertificateServer",
                                      "UserTokenUserNamePasswordServer",
                                      "UserTokenJwtServer",
                                      "ReverseConnectServer"}) {
        INFO(profile);
        CHECK(first_lack(everything(), profile) == "");
        CHECK(is_claimed(everything(), profile));
    }
}

TEST_CASE("what nobody has written is not claimed")
{
    CHECK(first_lack(everything(), "Auditing") == "Auditing Base: audit");
    CHECK_FALSE(is_claimed(everything(), "GlobalCertificateManagement"));
    CHECK_FALSE(is_claimed(everything(), "Standard2022Server"));
    CHECK_FALSE(is_claimed(everything(), "Standard2025Server"));
}

TEST_CASE("without a NodeVersion nobody is told of changes of the model (Part 3, 9.32.2)")
{
    ConformanceFacts facts = everything();
    std::erase(facts.instance_types, std::uint32_t{id::NodeVersion});
    CHECK(first_lack(facts, "ModelChangeEvent") == "Base Info Model Change: instance:NodeVersion");
    CHECK_FALSE(units_of(facts).contains("Base Info Model Change General"));
}

TEST_CASE("without users of certificates there is no Standard 2017")
{
    ConformanceFacts facts = everything();
    facts.users_certificate = false;
    CHECK(first_lack(facts, "Standard2017Server") == "Security User X509: users:certificate");
    CHECK(is_claimed(facts, "Embedded2017Server"));
}

TEST_CASE("fewer sessions than a profile asks for do not do")
{
    ConformanceFacts facts = everything();
    facts.sessions = 49;
    CHECK(first_lack(facts, "Standard2017Server") == "Session Minimum 50 Parallel: sessions>=50");
    CHECK(is_claimed(facts, "Embedded2017Server"));
    facts.sessions = 1;
    CHECK_FALSE(is_claimed(facts, "Micro2017Server"));
    CHECK(is_claimed(facts, "Nano2017Server"));
}

TEST_CASE("what an included profile lacks its users lack, once")
{
    ConformanceFacts facts = everything();
    facts.triggering = false;
    const Conformance conformance = assess(facts);
    for (const char* const profile :
         {"StandardDataChangeSubscription2017", "Embedded2017Server", "Standard2017Server"}) {
        INFO(profile);
        const auto& lacks = conformance.find(profile)->lacks;
        REQUIRE(lacks.size() == 1);
        CHECK(lacks[0].unit == "Monitor Triggering");
        CHECK(lacks[0].need == "triggering");
    }
    CHECK(conformance.find("Micro2017Server")->is_claimed);
}

TEST_CASE("one of several policies may be enough")
{
    ConformanceFacts facts = everything();
    facts.policy_aes128 = facts.policy_aes256 = false;
    const char* const unit = "AsymmetricSignatureAlgorithm_RSA-PKCS15-SHA2-256";
    CHECK(units_of(facts).count(unit) == 1);
    facts.policy_basic256sha256 = false;
    CHECK(units_of(facts).count(unit) == 0);
}

TEST_CASE("instances and the size of namespace 0 count")
{
    ConformanceFacts facts = everything();
    facts.instance_types = {id::AnalogItemType};
    CHECK(first_lack(facts, "DataAccess") == "Data Access DataItems: instance:DataItemType");
    facts = everything();
    facts.namespace0 = server::Namespace0Size::Embedded;
    CHECK_FALSE(is_claimed(facts, "ComplexTypes2017"));
    CHECK(is_claimed(facts, "Embedded2017Server"));
}

TEST_CASE("what only the program knows counts where it is declared")
{
    ConformanceFacts facts = everything();
    CHECK(units_of(facts).count("Protocol Configuration") == 0);
    facts.declared_units = {"Protocol Configuration", "Auditing Base"};
    CHECK(units_of(facts).count("Protocol Configuration") == 1);
    CHECK(units_of(facts).count("Auditing Base") == 0);
}

TEST_CASE("clients are assessed apart from servers")
{
    ConformanceFacts facts;
    CHECK(assess(facts).client_units.empty());
    facts.client = true;
    const Conformance conformance = assess(facts);
    const auto& own = conformance.client_units;
    CHECK(std::find(own.begin(), own.end(), "Session Client Base") != own.end());
    CHECK(units_of(facts).count("Session Client Base") == 0);
    CHECK(conformance.find("MethodClient")->is_client);
    CHECK(conformance.find("MethodClient")->is_claimed);
    CHECK_FALSE(conformance.find("Methods")->is_client);
}

} // namespace conformance_test
