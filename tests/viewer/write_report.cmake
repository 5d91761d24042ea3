# Writes the report that check_report.mjs looks at; its model is one of carat's own.
set(model ${FOLDER}/model.ply)
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${CARAT} generate sphere-hexagons --level 2 --jitter 0.2 -o ${model}
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CARAT} reproduce franke-plane harmonic-sphere franke-cube cost-surface
                        columns curvature-picture geodesics-picture --quick --model ${model}
                        -o ${FOLDER}
                COMMAND_ERROR_IS_FATAL ANY)
