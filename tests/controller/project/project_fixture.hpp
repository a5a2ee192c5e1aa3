#pragma once

#include <string>
#include <string_view>

#include <busbar/controller/project.hpp>

namespace busbar::test {

/// Of nobody: the shape of crypto::hash_password's output, with the smallest cost.
inline constexpr std::string_view password_hash_of_nobody =
    "$scrypt$14$8$1$AAAAAAAAAAAAAAAAAAAAAA==$AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=";

inline std::string model_text(const std::string& uri, const std::string& nodes = {})
{
    return "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n"
           "  <NamespaceUris><Uri>" +
           uri + "</Uri></NamespaceUris>\n  <Models><Model ModelUri=\"" + uri + "\"/></Models>\n" +
           nodes + "</UANodeSet>\n";
}

/// Something other than the default in every section.
inline controller::Project press_project()
{
    using namespace controller;
    Project project;
    project.network.listeners = {
        {ListenerUse::DataAndAdministration, "192.168.3.40", "255.255.255.0", 4'840},
        {ListenerUse::Administration, "10.1.0.7", "255.255.0.0", 4'841}};
    project.network.gateway = "192.168.3.1";
    project.network.host_name = "PRESS4";
    project.security.policies = {"Basic256Sha256"};
    project.security.mode = MessageSecurityMode::SignAndEncrypt;
    project.certificate = {"Press_4", "Works", "Hall_2", "Ulm", "Baden", "DE"};
    project.discovery = {"opc.tcp://192.168.3.250:4840", 60};
    project.sampling = ProjectSampling::HighSpeedItems;
    project.users = {
        {"engineer", ProjectPermission::ToolAndClient, std::string{password_hash_of_nobody}},
        {"hmi", ProjectPermission::Client, std::string{password_hash_of_nobody}}};
    project.models = {{"Types.xml", model_text("http://press.example/types")},
                      {"Press.xml", model_text("http://press.example/press")}};
    return project;
}

} // namespace busbar::test
