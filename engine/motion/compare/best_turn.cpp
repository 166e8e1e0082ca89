#include "motion/compare/best_turn.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace neuvv::motion {

glm::dmat3 BestTurn::turn() const {
    Eigen::Matrix3d sum;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) sum(row, column) = sum_[column][row];
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign(2, 2) = -1;  // a reflection is none
    const Eigen::Matrix3d turn = svd.matrixU() * sign * svd.matrixV().transpose();
    glm::dmat3 result;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) result[column][row] = turn(row, column);
    return result;
}

}  // namespace neuvv::motion
