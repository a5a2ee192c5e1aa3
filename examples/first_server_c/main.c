/* A server with one variable and the security that a server has by default, in C99.
 * usage: FIRST_SERVER_PASSWORD=... first-server-c [PORT] */
#include <stdio.h>
#include <stdlib.h>

#include <busbar/busbar.h>

int main(int argc, char** argv)
{
    char hash[160];
    const busbar_user user = {"operator", hash, false};
    busbar_status status =
        busbar_hash_password(getenv("FIRST_SERVER_PASSWORD"), 0, hash, sizeof hash);
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:example:first-server-c";
    config.application.name = "First server in C";
    config.application.folder = "first_server_c_pki";
    config.port = (uint16_t)atoi(argc > 1 ? argv[1] : "4840");
    config.users = &user;
    config.user_count = 1;
    busbar_server* server = NULL;
    status = status != 0 ? status : busbar_server_create(&config, &server);

    busbar_variable speed;
    busbar_variable_init(&speed);
    uint16_t* const machine = &speed.node.namespace_index;
    status = status ? status : busbar_server_add_namespace(server, "urn:example:machine", machine);
    speed.node.name = "Speed";
    speed.value = busbar_value_double(1480);
    speed.is_writable = true;
    status = status ? status : busbar_server_add_variable(server, &speed, NULL);
    status = status ? status : busbar_server_start(server);
    fprintf(stderr, "%s at port %d\n", status ? "failed" : "ready", busbar_server_port(server));
    status = status ? status : busbar_server_run(server, true);
    fprintf(stderr, "%s %s\n", busbar_status_name(status), busbar_server_last_error(server));
    busbar_server_destroy(server);
    return status != 0;
}
